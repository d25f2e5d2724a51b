#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace filasofia::scene {

/// Numbers with one unit behind them, as scene files write them: "10 kPa", "-0.5 mm", "10 20 30 mm".
struct Quantity {
    std::vector<double> values; ///< as written
    std::string_view unit;      ///< empty: none
};

/// Splits a text into its numbers and its unit; nothing if it does not begin with a number.
std::optional<Quantity> parseQuantity(std::string_view text);

/// A factor and a divisor apart, so that "30 deg" has the bits of 30_deg.
struct Scale {
    double factor = 1.0;
    double divisor = 1.0;
};

/// What turns a value in the unit `from` into the unit `to` of a field, such as "kN/m" into "N/m"; nothing if they
/// measure different things, or if `from` is no unit. "rad or m" takes either.
std::optional<Scale> convert(std::string_view from, std::string_view to);

/// The unit that a wrong one is meant to be if only capitals differ, such as "kPa" for "kpa"; else empty.
std::string nearestUnit(std::string_view wrong);

} // namespace filasofia::scene
