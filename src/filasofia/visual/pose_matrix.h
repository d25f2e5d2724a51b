#pragma once

#include "filasofia/math/mat3.h"
#include "filasofia/math/pose.h"

#include <math/mat4.h>

namespace filasofia::visual {

/// The pose as a matrix for Filament's transforms.
inline filament::math::mat4f matrixOf(const Pose& pose, double scale = 1.0)
{
    const Mat3 r = scale * toMat3(pose.orientation);
    filament::math::mat4f m;
    for (int column = 0; column < 3; ++column) {
        const Vec3 axis = r.column(column);
        m[std::size_t(column)] = {float(axis.x), float(axis.y), float(axis.z), 0.0F};
    }
    m[3] = {float(pose.position.x), float(pose.position.y), float(pose.position.z), 1.0F};
    return m;
}

} // namespace filasofia::visual
