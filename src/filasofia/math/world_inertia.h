#pragma once

#include "filasofia/math/quat.h"

namespace filasofia {

/// A body's inertia tensor in world axes, from that along its own axes.
inline Mat3 worldInertia(const Mat3& inertia, Quat orientation)
{
    const Mat3 r = toMat3(orientation);
    return r * inertia * transpose(r);
}

} // namespace filasofia
