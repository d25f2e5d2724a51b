#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace filasofia::geometry {

/// Four node indices; positive volume means dot(b - a, cross(c - a, d - a)) > 0.
using Tetrahedron = std::array<int, 4>;

/// The faces of a tetrahedron of positive volume as local indices of its four nodes, counter-clockwise seen from
/// outside. Face i lies opposite node i.
inline constexpr std::array<std::array<int, 3>, 4> kTetrahedronFaces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
/// The six edges of a tetrahedron as local indices of its four nodes.
inline constexpr std::array<std::array<int, 2>, 6> kTetrahedronEdges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

/// The name of a label of a mesh.
struct MeshLabel {
    int label = 0; ///< [-]
    std::string name = {};

    friend bool operator==(const MeshLabel&, const MeshLabel&) = default;
};

/// A volume mesh of tetrahedra.
struct TetMesh {
    std::vector<Vec3> nodes;             ///< [m]
    std::vector<Tetrahedron> tetrahedra; ///< indices into nodes
    /// [-] One per tetrahedron, the part of the body that it belongs to: the physical group of a Gmsh file, the first
    /// attribute of a TetGen file, the first list of whole numbers per cell of a VTK file. Empty: none.
    std::vector<int> labels = {};
    std::vector<MeshLabel> labelNames = {}; ///< the names of some labels, each name once
};

/// Volume [m^3], negative if the tetrahedron is inverted.
constexpr double signedVolume(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(b - a, cross(c - a, d - a)) / 6.0; }
double signedVolume(const TetMesh& mesh, int tetrahedron);

/// Quality q = sqrt(2) 6 V / l_rms^3 in (-inf, 1], with l_rms the root mean square of the six edges; 1 for the regular
/// tetrahedron, 0 for a flat one (also for one shrunk to a point).
double quality(const TetMesh& mesh, int tetrahedron);

/// Throws an Error naming `name`, the element or node, and the bound, unless the mesh has a tetrahedron, every number
/// is finite, every index names a node, no tetrahedron names a node twice, and every volume is positive (more than
/// 1e-12 of the cube of its longest edge). A node in no tetrahedron is an Error too, and so is a face that two
/// tetrahedra have on the same side (one listed twice, or two that overlap). Labels, if there are any, are one per
/// tetrahedron.
void check(const TetMesh& mesh, std::string_view name);

/// Drops the nodes that no tetrahedron uses; the others keep their order and get new numbers. Returns how many it
/// dropped: none if a tetrahedron names a node that is not there, which check() refuses.
std::size_t dropUnusedNodes(TetMesh& mesh);

} // namespace filasofia::geometry
