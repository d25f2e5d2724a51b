#pragma once

#include "filasofia/visual/view.h"

#include <filament/View.h>
#include <filament/Viewport.h>

namespace filasofia::visual {

/// Switches these effects on and all others off; endoscope optics are a pass of their own. `blurScale` corrects for the
/// f-number that the library's camera has in place of the requested one (exposeCamera).
void applyEffects(filament::View& view, const Effects& effects, double blurScale);

/// Sets exposure and focus. Returns the ratio of the f-number that was set to the requested one.
double exposeCamera(filament::Camera& camera, const CameraDef& def);

/// The pixels of `port` in a window of this size, at least one; Filament counts rows from below.
filament::Viewport pixelsOf(const Viewport& port, int windowWidth, int windowHeight);

} // namespace filasofia::visual
