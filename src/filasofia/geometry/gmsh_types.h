#pragma once

#include "filasofia/geometry/split_solid.h"

#include <optional>
#include <string_view>

namespace filasofia::geometry {

/// One of Gmsh's types of elements. An element of dimension 3 must not be skipped.
struct GmshType {
    std::string_view name;
    int dimension = 0;
    int nodes = 0;
    std::optional<Solid> solid = {}; ///< none: it is not read
};

/// The type of a number; none if Gmsh has no such type (of the first 31).
std::optional<GmshType> gmshType(std::int64_t number);

} // namespace filasofia::geometry
