#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <array>
#include <vector>

/// The meshes that MuJoCo makes for its flexible bodies, with its numbers of nodes and its way to split cells.
namespace filasofia::scene {

/// Nodes, and elements of `corners` nodes each: triangles or tetrahedra.
struct FlexMesh {
    std::vector<Vec3> nodes = {};   ///< [m]
    std::vector<int> elements = {}; ///< indices, `corners` for each element
    int corners = 4;
};

/// The surfaces that a box is projected on.
enum class FlexShape { Box, Cylinder, Ellipsoid };

/// The number of nodes, as a real number that does not overflow; for a hull of a box that of its surface.
double nodesOfGrid(const std::array<int, 3>& count);
double nodesOfHull(const std::array<int, 3>& count);

/// A flat grid of triangles in the xy plane, or a disc; counts >= 2 in x and y.
FlexMesh flexSheet(const std::array<int, 3>& count, Vec3 spacing, bool disc);
/// A grid whose cells are split into six tetrahedra each; counts >= 2.
FlexMesh flexGrid(const std::array<int, 3>& count, Vec3 spacing);
/// The surface of a box, cylinder or ellipsoid; as a solid, tetrahedra between node 0 in the middle and its triangles.
FlexMesh flexHull(const std::array<int, 3>& count, Vec3 spacing, FlexShape shape, bool solid);
/// Tetrahedra between `origin`, which is node 0, and the triangles that face away from it.
FlexMesh flexFan(const geometry::TriangleMesh& surface, Vec3 origin);

/// Drops nodes that no element uses; returns the new number of each, -1 for those that are dropped.
std::vector<int> dropUnused(FlexMesh& mesh);

/// The same mesh with all tetrahedra of positive volume.
geometry::TetMesh tetrahedraOf(const FlexMesh& mesh);
geometry::TriangleMesh trianglesOf(const FlexMesh& mesh);

} // namespace filasofia::scene
