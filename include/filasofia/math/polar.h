#pragma once

#include "filasofia/math/quat.h"

namespace filasofia {

/// The rotation nearest to f, also for flattened and inverted f: the R that maximises trace(R^T f) over all rotations.
/// Newton's method on quaternions from `guess` (usually the last step's answer), checked; where it does not arrive at
/// the maximum, the answer comes from the singular value decomposition. So the result does not depend on the guess
/// but for rounding, wherever the nearest rotation is unique.
Quat polarRotation(const Mat3& f, Quat guess);

} // namespace filasofia
