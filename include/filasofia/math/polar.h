#pragma once

#include "filasofia/math/quat.h"

namespace filasofia {

/// The rotation nearest to f, also for flattened and inverted f: the R that maximises trace(R^T f) over all rotations.
/// Newton's method on quaternions from `guess` (usually the result of the last step), checked; if it does not reach the
/// maximum, the singular value decomposition gives the result. So, wherever the nearest rotation is unique, the result
/// depends on the guess only in its rounding.
Quat polarRotation(const Mat3& f, Quat guess);

} // namespace filasofia
