#include "filasofia/visual/image.h"

#include "filasofia/core/error.h"
#include "filasofia/core/whole_file.h"

#include <stb/stb_image_write.h>

#include <string>

namespace filasofia::visual {

void savePng(const Image& image, const std::filesystem::path& file)
{
    const std::size_t pixels = std::size_t(std::max(image.width, 0)) * std::size_t(std::max(image.height, 0));
    if (pixels == 0 || image.rgba.size() != 4 * pixels)
        fail("cannot write picture '", file.string(), "': it is ", image.width, " x ", image.height, " pixels with ",
             image.rgba.size(), " bytes");
    // Opaque, because the scene's alpha means nothing to the reader of the file.
    std::vector<std::uint8_t> rgb(3 * pixels);
    for (std::size_t i = 0; i < pixels; ++i)
        for (std::size_t k = 0; k < 3; ++k) rgb[3 * i + k] = image.rgba[4 * i + k];
    // Encoded into memory, because stb checks neither its writes nor its close: a full disk would go unnoticed.
    std::string png;
    const auto append = [](void* out, void* data, int size) {
        static_cast<std::string*>(out)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
    };
    const bool encoded =
        stbi_write_png_to_func(append, &png, image.width, image.height, 3, rgb.data(), 3 * image.width);
    if (!encoded) fail("cannot write picture '", file.string(), "': it could not be encoded");
    writeWhole(file, png);
}

} // namespace filasofia::visual
