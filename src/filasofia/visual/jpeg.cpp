#include "filasofia/visual/jpeg.h"

#include "filasofia/core/error.h"

#include <stb/stb_image_write.h>

#include <algorithm>

namespace filasofia::visual {

std::string encodeJpeg(int width, int height, std::span<const std::uint8_t> rgba, int quality)
{
    const std::size_t pixels = std::size_t(std::max(width, 0)) * std::size_t(std::max(height, 0));
    if (pixels == 0 || rgba.size() != 4 * pixels)
        fail("JPEG: a picture of ", width, " x ", height, " pixels with ", rgba.size(), " bytes cannot be encoded");
    if (quality < 1 || quality > 100) fail("JPEG: quality must be in [1, 100], got ", quality);
    std::string jpeg;
    const auto append = [](void* out, void* data, int size) {
        static_cast<std::string*>(out)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
    };
    if (!stbi_write_jpg_to_func(append, &jpeg, width, height, 4, rgba.data(), quality))
        fail("JPEG: a picture of ", width, " x ", height, " pixels could not be encoded");
    return jpeg;
}

} // namespace filasofia::visual
