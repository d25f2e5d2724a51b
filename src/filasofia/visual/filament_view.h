#pragma once

#include "filasofia/visual/view.h"

#include <filament/View.h>
#include <filament/Viewport.h>

namespace filasofia::visual {

/// Switches the effects of `quality` on and all others off. `occlusionRadius` in [m].
void applyQuality(filament::View& view, Quality quality, double occlusionRadius);

/// The pixels of `port` in a window of this size, at least one; Filament counts rows from below.
filament::Viewport pixelsOf(const Viewport& port, int windowWidth, int windowHeight);

} // namespace filasofia::visual
