#include "filasofia/visual/depth_views.h"

#include <algorithm>
#include <cmath>

namespace filasofia::visual {
namespace {

std::size_t indexOf(const DepthImage& image, int x, int y)
{
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
}

} // namespace

DepthImage emptyDepth(int width, int height)
{
    const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    return {width, height, std::vector<float>(count, DepthImage::kNothing), std::vector<std::uint32_t>(count)};
}

void place(const DepthImage& view, int left, int top, DepthImage& window)
{
    const int columns = std::min(view.width, window.width - left), rows = std::min(view.height, window.height - top);
    for (int y = 0; y < rows; ++y) {
        const auto from = static_cast<std::ptrdiff_t>(indexOf(view, 0, y));
        const auto to = static_cast<std::ptrdiff_t>(indexOf(window, left, top + y));
        std::copy_n(view.depth.begin() + from, columns, window.depth.begin() + to);
        std::copy_n(view.label.begin() + from, columns, window.label.begin() + to);
    }
}

DepthImage throughLens(const DepthImage& image, const EndoscopeOptics& optics)
{
    DepthImage out = emptyDepth(image.width, image.height);
    const double smaller = std::min(image.width, image.height);
    const double rim = optics.maskRadius, k = optics.distortion;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            // From the middle, in halves of the smaller side.
            const double right = (2.0 * x + 1.0 - image.width) / smaller,
                         down = (2.0 * y + 1.0 - image.height) / smaller;
            const double r2 = right * right + down * down;
            if (r2 >= rim * rim) continue;
            const double shrink = (1.0 + k * r2) / (1.0 + k * rim * rim);
            const auto pixel = [&](double at, int size) {
                return std::clamp(static_cast<int>(std::floor(0.5 * (at * shrink * smaller + size))), 0, size - 1);
            };
            const std::size_t from = indexOf(image, pixel(right, image.width), pixel(down, image.height));
            out.depth[indexOf(out, x, y)] = image.depth[from];
            out.label[indexOf(out, x, y)] = image.label[from];
        }
    return out;
}

} // namespace filasofia::visual
