#include "filasofia/core/error.h"
#include "filasofia/core/user_file.h"
#include "filasofia/visual/image.h"

#include <stb/stb_image.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>

namespace filasofia::visual {
namespace {

constexpr int kMaxSide = 8192; ///< [px] per side; every card supports it

/// Width and height from a PNG's first chunk; zero if it is not a PNG. stb refuses large ones without reporting their
/// size.
std::array<std::uint64_t, 2> pngSize(const std::filesystem::path& file)
{
    std::array<unsigned char, 24> head{};
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(head.data()), head.size());
    constexpr std::array<unsigned char, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    if (!in || !std::equal(kSignature.begin(), kSignature.end(), head.begin())) return {0, 0};
    const auto number = [&](std::size_t at) {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < 4; ++i) value = 256 * value + head[at + i];
        return value;
    };
    return {number(16), number(20)};
}

void checkSize(const std::filesystem::path& file, std::uint64_t width, std::uint64_t height)
{
    if (width > kMaxSide || height > kMaxSide)
        fail("picture '", file.string(), "': must be at most ", kMaxSide, " x ", kMaxSide, " pixels, got ", width,
             " x ", height);
}

} // namespace

Image loadImage(const std::filesystem::path& file)
{
    checkRegularFile(file, text("picture '", file.string(), "'"));
    const auto [pngWidth, pngHeight] = pngSize(file);
    checkSize(file, pngWidth, pngHeight);

    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> in(std::fopen(file.c_str(), "rb"), std::fclose);
    if (!in) fail("picture '", file.string(), "': cannot be opened");
    int width = 0, height = 0, channels = 0;
    const auto refuse = [&] {
        const char* reason = stbi_failure_reason();
        fail("picture '", file.string(), "': is not a complete PNG or JPEG", reason ? text(" (", reason, ")") : "");
    };
    if (!stbi_info_from_file(in.get(), &width, &height, &channels)) refuse();
    checkSize(file, std::uint64_t(width), std::uint64_t(height));
    const std::unique_ptr<unsigned char, void (*)(void*)> pixels(
        stbi_load_from_file(in.get(), &width, &height, &channels, 4), stbi_image_free);
    if (!pixels) refuse();
    const std::size_t bytes = 4 * std::size_t(width) * std::size_t(height);
    return {width, height, {pixels.get(), pixels.get() + bytes}};
}

} // namespace filasofia::visual
