#include "visual/picture_check.h"

#include <catch2/catch.hpp>

#include <stb/stb_image.h>

#include <cstdlib>
#include <filesystem>

using filasofia::visual::Image;

namespace {

Image loadPng(const std::filesystem::path& file)
{
    Image image;
    int channels = 0;
    unsigned char* pixels = stbi_load(file.c_str(), &image.width, &image.height, &channels, 4);
    if (!pixels) return image;
    image.rgba.assign(pixels, pixels + 4 * std::size_t(image.width) * std::size_t(image.height));
    stbi_image_free(pixels);
    return image;
}

} // namespace

void checkPicture(const Image& image, const std::string& name)
{
    const std::filesystem::path reference =
        std::filesystem::path(FILASOFIA_SOURCE_DIR) / "tests/visual/pictures" / (name + ".png");
    if (const char* update = std::getenv("FILASOFIA_UPDATE_PICTURES"); update && std::string(update) == "1") {
        savePng(image, reference);
        return;
    }
    const Image expected = loadPng(reference);
    INFO("picture " << reference);
    REQUIRE(expected.width == image.width);
    REQUIRE(expected.height == image.height);
    int beyond = 0;
    for (std::size_t pixel = 0; pixel < image.rgba.size(); pixel += 4) {
        int largest = 0;
        for (std::size_t part = 0; part < 3; ++part)
            largest = std::max(largest, std::abs(int(image.rgba[pixel + part]) - int(expected.rgba[pixel + part])));
        beyond += largest > 2;
    }
    const std::filesystem::path shown = std::filesystem::path(FILASOFIA_BINARY_DIR) / (name + "_differs.png");
    if (1000 * beyond > image.width * image.height) savePng(image, shown);
    INFO("as it is now: " << shown);
    CHECK(1000 * beyond <= image.width * image.height);
}
