#pragma once

#include "filasofia/visual/depth_image.h"
#include "filasofia/visual/effects.h"

namespace filasofia::visual {

/// Nothing is seen.
DepthImage emptyDepth(int width, int height);

/// Places the image of a view into that of the window, with its upper left corner at (left, top).
void place(const DepthImage& view, int left, int top, DepthImage& window);

/// The image as endoscope optics show it: pixels move as those of the colours do (materials/optics.mat), nothing is
/// seen outside the round field, and nothing is blurred.
DepthImage throughLens(const DepthImage& image, const EndoscopeOptics& optics);

} // namespace filasofia::visual
