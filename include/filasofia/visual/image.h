#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace filasofia::visual {

/// A picture: rows from top to bottom, four bytes per pixel (red, green, blue, alpha), sRGB encoded.
struct Image {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba; ///< 4 width height bytes

    /// The pixel in column x from the left and row y from the top; both must lie inside.
    [[nodiscard]] std::array<std::uint8_t, 4> pixel(int x, int y) const
    {
        const std::size_t at = 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + std::size_t(x));
        return {rgba[at], rgba[at + 1], rgba[at + 2], rgba[at + 3]};
    }
    friend bool operator==(const Image&, const Image&) = default;
};

/// Writes the picture as an opaque PNG. Throws an Error naming the file if it cannot be written, or if the picture has
/// no pixels or not four bytes for each.
void savePng(const Image& image, const std::filesystem::path& file);

/// Reads a PNG or JPEG. Throws an Error naming the file if it is missing, damaged, or has more than 8192 pixels per
/// side (which its first bytes tell, before anything is decoded).
Image loadImage(const std::filesystem::path& file);

} // namespace filasofia::visual
