#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <string_view>
#include <vector>

namespace filasofia::geometry {

/// Three vertex indices, counter-clockwise seen from outside.
using Triangle = std::array<int, 3>;

/// A surface mesh of triangles.
struct TriangleMesh {
    std::vector<Vec3> vertices;      ///< [m]
    std::vector<Triangle> triangles; ///< indices into vertices
    /// [-], empty, one per vertex, or, if the texture has seams, three per triangle (texture_seams.h); (0, 0) is the
    /// image's lower left corner
    std::vector<std::array<double, 2>> uv;
};

/// Throws an Error naming `name`, the triangle or vertex, and the bound, unless there is a triangle, every number is
/// finite, every index names a vertex, no triangle names a vertex twice, and uv has as many pairs as it may.
void check(const TriangleMesh& mesh, std::string_view name);

} // namespace filasofia::geometry
