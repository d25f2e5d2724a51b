#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <cstdint>
#include <vector>

namespace filasofia::frame {

/// The boundary of a body that may be cut, as it is until the next edit of its mesh.
struct Boundary {
    std::uint64_t revision = 0;                     ///< edits made; 0: as it was given
    std::vector<geometry::Triangle> triangles = {}; ///< by nodes, outwards
    std::vector<std::uint8_t> opened = {};          ///< per triangle, 1: inside the tissue until a cut or a tear
    std::vector<int> behind = {};                   ///< per triangle, the fourth node of its tetrahedron
    std::vector<Vec3> rest = {};                    ///< [m] per node of the body, in world coordinates
};

} // namespace filasofia::frame
