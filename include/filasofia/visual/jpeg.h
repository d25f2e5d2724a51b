#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace filasofia::visual {

/// A picture as the bytes of a JPEG. `rgba`: rows from top to bottom, four bytes per pixel, sRGB encoded; opacity is
/// ignored. `quality`: [-], in [1, 100]. Throws an Error if the picture has no pixels or not four bytes for each.
std::string encodeJpeg(int width, int height, std::span<const std::uint8_t> rgba, int quality = 90);

} // namespace filasofia::visual
