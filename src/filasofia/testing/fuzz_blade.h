#pragma once

#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/math/mat3.h"
#include "filasofia/math/quat.h"

#include <memory>

namespace filasofia::testing {

/// A blade: a rectangle whose leading edge is the x axis and which trails along -y.
inline std::shared_ptr<const geometry::TriangleMesh> bladeOf(double size)
{
    const double half = 1.5 * size;
    return std::make_shared<const geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {{-half, 0, 0}, {half, 0, 0}, {half, -2 * half, 0}, {-half, -2 * half, 0}},
                               .triangles = {{0, 1, 2}, {0, 2, 3}},
                               .uv = {}});
}

/// The rotation that takes x and y to these directions, which are perpendicular.
inline Quat frameOf(Vec3 x, Vec3 y)
{
    const Vec3 z = cross(x, y);
    return toQuat(Mat3{{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}});
}

} // namespace filasofia::testing
