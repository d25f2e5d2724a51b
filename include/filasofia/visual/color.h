#pragma once

#include "filasofia/core/fields.h"

namespace filasofia::visual {

/// Linear RGB (not sRGB).
struct Color {
    double red = 0.0;   ///< [-], in [0, 1]
    double green = 0.0; ///< [-], in [0, 1]
    double blue = 0.0;  ///< [-], in [0, 1]

    friend constexpr bool operator==(const Color&, const Color&) = default;
};

constexpr auto fields(const Color*)
{
    return describe("Color", field("red", &Color::red, "-", closed(0, 1), "linear red"),
                    field("green", &Color::green, "-", closed(0, 1), "linear green"),
                    field("blue", &Color::blue, "-", closed(0, 1), "linear blue"));
}

} // namespace filasofia::visual
