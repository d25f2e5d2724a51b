#pragma once

#include "filasofia/visual/view.h"

namespace filasofia::visual {

/// A rectangle of pixels with rows counted from the top: those in [left, right) and [top, bottom).
struct PixelArea {
    int left = 0;
    int top = 0;
    int right = 0;
    int bottom = 0;

    [[nodiscard]] int width() const { return right - left; }
    [[nodiscard]] int height() const { return bottom - top; }
    friend bool operator==(const PixelArea&, const PixelArea&) = default;
};

/// The pixels of `port` in a window of this size, at least one.
PixelArea pixelArea(const Viewport& port, int windowWidth, int windowHeight);

} // namespace filasofia::visual
