#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <filesystem>

namespace filasofia::scene {

/// The triangles of a Collada file (.dae), which robots in URDF are drawn with: the meshes of its scene, placed by its
/// nodes, in metres as its unit says. As in ROS, its up axis does not turn it. Textures, materials and normals are left
/// out; polygons are split into fans. Throws an Error that begins with the file.
geometry::TriangleMesh loadCollada(const std::filesystem::path& file);

} // namespace filasofia::scene
