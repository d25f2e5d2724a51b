#pragma once

#include "filasofia/core/error.h"

#include <cmath>
#include <cstdint>
#include <string_view>

/// What the arguments of shapes must be.
namespace filasofia::geometry::shapes {

inline void checkLength(std::string_view shape, std::string_view argument, double value)
{
    if (!(value > 0.0 && std::isfinite(value))) fail(shape, ": ", argument, " must be > 0 m, got ", value);
}

inline void checkCount(std::string_view shape, std::string_view argument, int value, int least, int most)
{
    if (value < least || value > most)
        fail(shape, ": ", argument, " must be in [", least, ", ", most, "], got ", value);
}

/// Far more than a step can compute in real time: beyond it a slip of the pen would fill the memory.
constexpr std::int64_t kMostTetrahedra = 3'000'000;

inline void checkTetrahedra(std::string_view shape, std::int64_t count)
{
    if (count > kMostTetrahedra) fail(shape, ": cells must make at most ", kMostTetrahedra, " tetrahedra, got ", count);
}

} // namespace filasofia::geometry::shapes
