#pragma once

#include "filasofia/visual/overlay_backend.h"

struct ImFontAtlas;
struct ImGuiStyle;

namespace filasofia::visual {

/// Our dark theme, with sizes for texts `scale` times as large as at 96 dots per inch.
ImGuiStyle themeOf(double scale);

/// Sets the atlas's one font, DejaVu Sans, for that scale, and rasterises it: at every scale texts are as sharp as the
/// pixels.
GlyphSheet rasterise(ImFontAtlas& atlas, double scale);

} // namespace filasofia::visual
