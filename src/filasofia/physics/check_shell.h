#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <string>

namespace filasofia::physics {

/// Throws an Error that begins with `object` unless a shell can be made of the mesh: every vertex belongs to a
/// triangle, no triangle is flat or given twice, every edge belongs to one or two triangles, two with a common edge
/// face the same way and, if the shell `bends`, do not lie on each other; and a closed shell faces outwards.
void checkShell(const geometry::TriangleMesh& mesh, bool bends, const std::string& object);

} // namespace filasofia::physics
