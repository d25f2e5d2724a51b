#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <cstdint>
#include <vector>

namespace filasofia::frame {

/// The boundary of a body that may be cut; valid until the next edit of its mesh.
struct Boundary {
    std::uint64_t revision = 0;                     ///< number of edits; 0 for the mesh as it was given
    std::vector<geometry::Triangle> triangles = {}; ///< node indices, counter-clockwise seen from outside
    std::vector<std::uint8_t> opened =
        {};                       ///< per triangle, 1 if it was inside the tissue until a cut or a tear opened it
    std::vector<int> behind = {}; ///< per triangle, the fourth node of its tetrahedron; -1 in a shell
    std::vector<Vec3> rest = {};  ///< [m] per node of the body, in world coordinates
};

} // namespace filasofia::frame
