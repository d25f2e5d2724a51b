#include "filasofia/geometry/gmsh_types.h"

#include <iterator>

namespace filasofia::geometry {

std::optional<GmshType> gmshType(std::int64_t number)
{
    static constexpr GmshType kTypes[] = {
        {},
        {"line", 1, 2},
        {"triangle", 2, 3},
        {"quadrangle", 2, 4},
        {"tetrahedron", 3, 4, Solid::Simplex},
        {"hexahedron", 3, 8, Solid::Hexahedron},
        {"prism", 3, 6, Solid::Prism},
        {"pyramid", 3, 5, Solid::Pyramid},
        {"second-order line", 1, 3},
        {"second-order triangle", 2, 6},
        {"second-order quadrangle", 2, 9},
        {"second-order tetrahedron", 3, 10, Solid::Simplex},
        {"second-order hexahedron", 3, 27},
        {"second-order prism", 3, 18},
        {"second-order pyramid", 3, 14},
        {"point", 0, 1},
        {"second-order quadrangle of 8 nodes", 2, 8},
        {"second-order hexahedron of 20 nodes", 3, 20},
        {"second-order prism of 15 nodes", 3, 15},
        {"second-order pyramid of 13 nodes", 3, 13},
        {"third-order triangle of 9 nodes", 2, 9},
        {"third-order triangle", 2, 10},
        {"fourth-order triangle of 12 nodes", 2, 12},
        {"fourth-order triangle", 2, 15},
        {"fifth-order triangle of 15 nodes", 2, 15},
        {"fifth-order triangle", 2, 21},
        {"third-order line", 1, 4},
        {"fourth-order line", 1, 5},
        {"fifth-order line", 1, 6},
        {"third-order tetrahedron", 3, 20},
        {"fourth-order tetrahedron", 3, 35},
        {"fifth-order tetrahedron", 3, 56},
    };
    if (number < 1 || number >= static_cast<std::int64_t>(std::size(kTypes))) return {};
    return kTypes[number];
}

} // namespace filasofia::geometry
