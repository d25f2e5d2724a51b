#pragma once

#include "filasofia/core/error.h"

#include <cmath>
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

} // namespace filasofia::geometry::shapes
