#pragma once

#include "filasofia/visual/overlay_backend.h"

struct ImFontAtlas;
struct ImGuiStyle;

namespace filasofia::visual {

/// Our dark theme, with sizes for text `scale` times as large as at 96 dots per inch.
ImGuiStyle themeOf(double scale);

/// Sets the atlas's only font, DejaVu Sans, for this scale and rasterises it, so that text is sharp at every scale.
GlyphSheet rasterise(ImFontAtlas& atlas, double scale);

} // namespace filasofia::visual
