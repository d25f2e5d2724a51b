#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <filesystem>
#include <string>

namespace filasofia::geometry {

/// Reads the tetrahedra of a Gmsh .msh (1, 2 to 2.2 or 4.1, ASCII or binary), of a Medit .mesh, of an unstructured grid
/// of VTK (a legacy .vtk or an XML .vtu) or of a TetGen .node/.ele pair (either name) and checks them. Hexahedra,
/// prisms and pyramids are split into tetrahedra. Of tetrahedra of second order only the corners are read: a warning
/// counts the nodes that are left out. Other solids of a higher order are refused. Other elements (points, lines,
/// triangles, quadrangles) are skipped, and nodes that no tetrahedron uses are dropped; the rest keep their order.
/// `scale` [m], > 0, is the length of one unit of the file: 1e-3 for millimetres. `labels` names the list of whole
/// numbers per cell of a VTK file that become the labels. Empty: the first one, unless it numbers the cells; the log
/// says which if there are several. Throws an Error naming the file, the line (ASCII) or byte (binary), the element,
/// and the bound; or, with the names that there are, if there is no such list.
TetMesh loadTetMesh(const std::filesystem::path& file, double scale = 1.0, const std::string& labels = {});

/// Reads a triangle mesh from OBJ, STL, PLY, glTF (.gltf, .glb), OFF, the polydata or unstructured grids of VTK (legacy
/// .vtk, XML .vtp and .vtu) or the triangles of a Medit .mesh. OFF, VTK and Medit files keep their points in double
/// precision and in their order; polygons become fans, and a warning counts solids, which are left out. With all
/// others: all meshes of the file become one, placed by the file's nodes. Vertices at exactly the same position are
/// merged and numbered in the order in which triangles use them; polygons are triangulated. Coordinates pass through
/// single precision. If a merged vertex has several texture coordinates, uv has three pairs per triangle; a part
/// without any gets (0, 0). Triangles that name a vertex twice after merging are dropped; a warning in the log counts
/// what was dropped. `scale` [m], > 0, is the length of one unit of the file. A number must be a whole word (.5, +1 and
/// 1e-3 are; 1,5 and 0x10 are not), and a face must name what is there. Throws an Error naming the file, for text the
/// line, and what is wrong with it.
TriangleMesh loadTriangleMesh(const std::filesystem::path& file, double scale = 1.0);

} // namespace filasofia::geometry
