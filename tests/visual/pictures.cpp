#include "pictures.h"

#include "filasofia/visual/gpu.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>

namespace filasofia::visual {
namespace {

int pixelDifference(const Image& a, const Image& b, std::size_t pixel)
{
    int largest = 0;
    for (std::size_t k = 0; k < 3; ++k)
        largest = std::max(largest, std::abs(int(a.rgba[4 * pixel + k]) - int(b.rgba[4 * pixel + k])));
    return largest;
}

/// Ten times the difference, so that it can be seen.
Image differenceImage(const Image& a, const Image& b)
{
    Image out = a;
    for (std::size_t i = 0; i < a.rgba.size(); ++i)
        out.rgba[i] = std::uint8_t(std::min(255, 10 * std::abs(int(a.rgba[i]) - int(b.rgba[i]))));
    return out;
}

bool updating()
{
    const char* asked = std::getenv("FILASOFIA_UPDATE_PICTURES");
    return asked && std::string(asked) == "1";
}

/// The references were drawn by Mesa's software renderer. A graphics card samples textures and edges otherwise: on an
/// NVIDIA H200 at most 2.8 % of the pixels of a picture differed.
double allowedShare()
{
    static const double allowed = probeGpu().software ? 0.001 : 0.04;
    return allowed;
}

} // namespace

double differingShare(const Image& a, const Image& b, int tolerance)
{
    if (a.width != b.width || a.height != b.height) return 1.0;
    const std::size_t pixels = a.rgba.size() / 4;
    std::size_t differing = 0;
    for (std::size_t i = 0; i < pixels; ++i) differing += pixelDifference(a, b, i) > tolerance;
    return double(differing) / double(pixels);
}

void checkPicture(const Image& image, const std::string& name)
{
    const std::filesystem::path reference =
        std::filesystem::path(FILASOFIA_SOURCE_DIR) / "tests/visual/pictures" / (name + ".png");
    if (updating()) {
        savePng(image, reference);
        return;
    }
    const Image expected = loadImage(reference);
    const double allowed = allowedShare();
    const double share = differingShare(image, expected);
    if (share > allowed) {
        const std::filesystem::path folder = FILASOFIA_BINARY_DIR;
        savePng(image, folder / (name + "_actual.png"));
        if (image.rgba.size() == expected.rgba.size())
            savePng(differenceImage(image, expected), folder / (name + "_difference.png"));
    }
    INFO("picture " << name << ": " << 100.0 * share << " % of the pixels differ");
    CHECK(share <= allowed);
}

} // namespace filasofia::visual
