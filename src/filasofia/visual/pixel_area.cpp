#include "filasofia/visual/pixel_area.h"

#include <algorithm>
#include <cmath>

namespace filasofia::visual {

PixelArea pixelArea(const Viewport& port, int windowWidth, int windowHeight)
{
    // Edges are rounded, not sizes, so that neighbours have no gap.
    const auto edge = [](double fraction, int size) { return std::clamp(int(std::lround(fraction * size)), 0, size); };
    PixelArea area;
    area.left = std::min(edge(port.left, windowWidth), windowWidth - 1);
    area.right = std::max(edge(port.left + port.width, windowWidth), area.left + 1);
    area.top = std::min(edge(port.top, windowHeight), windowHeight - 1);
    area.bottom = std::max(edge(port.top + port.height, windowHeight), area.top + 1);
    return area;
}

} // namespace filasofia::visual
