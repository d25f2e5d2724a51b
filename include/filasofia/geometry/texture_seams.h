#pragma once

#include "filasofia/geometry/triangle_mesh.h"

/// Texture coordinates of meshes whose texture has seams: there a vertex has several.
namespace filasofia::geometry {

/// Whether uv has one pair for each corner of each triangle. Pairs that could be either are those of the vertices.
bool perCorner(const TriangleMesh& mesh);

/// Gives the mesh one pair of uv for each corner of each triangle. If it has as many vertices as corners, each vertex
/// gets the pair of its first corner.
void setUvOfCorners(TriangleMesh& mesh, std::vector<std::array<double, 2>> uv);

/// One pair of uv per vertex: at a seam, that of the first corner there. Empty if the mesh has none.
std::vector<std::array<double, 2>> uvOfVertices(const TriangleMesh& mesh);

} // namespace filasofia::geometry
