#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <string_view>
#include <vector>

namespace filasofia::geometry {

/// Four node indices; positive volume means dot(b - a, cross(c - a, d - a)) > 0.
using Tetrahedron = std::array<int, 4>;

/// A volume as tetrahedra.
struct TetMesh {
    std::vector<Vec3> nodes;             ///< [m]
    std::vector<Tetrahedron> tetrahedra; ///< indices into nodes
};

/// Volume [m^3], negative where the tetrahedron is inverted.
constexpr double signedVolume(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(b - a, cross(c - a, d - a)) / 6.0; }
double signedVolume(const TetMesh& mesh, int tetrahedron);

/// Quality q = sqrt(2) 6 V / l_rms^3 in (-inf, 1]; 1 for the regular tetrahedron, 0 for a flat one.
double quality(const TetMesh& mesh, int tetrahedron);

/// Throws an Error naming `name`, the element or node, and the bound, unless the mesh has a tetrahedron, every number
/// is finite, every index names a node, no tetrahedron names a node twice, and every volume is positive
/// (> 1e-12 of the cube of its longest edge). Nodes in no tetrahedron are an Error too.
void check(const TetMesh& mesh, std::string_view name);

} // namespace filasofia::geometry
