#pragma once

#include "filasofia/visual/image.h"
#include "filasofia/visual/texture.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <unistd.h>
#include <vector>

/// Texture maps of surfaces that are given as a height: what an artist bakes, made by formulas.
namespace filasofia::visual {

/// A square picture as a file: `texel(u, v)` gives red, green and blue in [0, 1]; (0, 0) is its lower left corner.
template <class Texel> TextureFile pictureFile(const std::string& name, int size, Texel&& texel)
{
    Image image{size, size, {}};
    const auto byte = [](double value) { return std::uint8_t(std::lround(255.0 * std::clamp(value, 0.0, 1.0))); };
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const auto [red, green, blue] = texel((x + 0.5) / size, 1.0 - (y + 0.5) / size);
            image.rgba.insert(image.rgba.end(), {byte(red), byte(green), byte(blue), 255});
        }
    // Tests run side by side, each in a process of its own.
    const std::string png = std::string(FILASOFIA_BINARY_DIR) + "/" + name + "_" + std::to_string(getpid()) + ".png";
    savePng(image, png);
    return {png};
}

/// A direction in [-1, 1] as a texel of a normal map: 128 is level.
inline std::array<double, 3> normalTexel(double x, double y, double z)
{
    const double length = std::sqrt(x * x + y * y + z * z);
    const auto shown = [&](double c) { return (128.0 + 127.0 * c / length) / 255.0; };
    return {shown(x), shown(y), shown(z)};
}

/// A normal map that leans the same way everywhere.
inline TextureFile leaningFile(const std::string& name, double x, double y)
{
    return pictureFile(name, 4, [&](double, double) { return normalTexel(x, y, 1.0); });
}

/// Soft mounds scattered over a tile that repeats, `cells` of them a side: minus the square of the distance to the
/// nearest of points scattered one to a cell (Worley, "A cellular texture basis function", 1996), in cells, with the
/// furrows between two of them rounded.
class Mounds {
public:
    Mounds(int cells, unsigned seed) : cells_(cells)
    {
        for (int i = 0; i < 2 * cells * cells; ++i) {
            seed = seed * 1664525U + 1013904223U;
            places_.push_back(0.1 + 0.8 * double(seed >> 8U) / 16777216.0);
        }
    }

    [[nodiscard]] double height(double u, double v) const
    {
        const double x = cells_ * (u - std::floor(u)), y = cells_ * (v - std::floor(v));
        constexpr double kSharp = 9.0; // a furrow's
        double sum = 0.0;
        for (int row = int(y) - 2; row <= int(y) + 2; ++row)
            for (int column = int(x) - 2; column <= int(x) + 2; ++column) {
                const std::size_t cell = std::size_t((row + cells_) % cells_ * cells_ + (column + cells_) % cells_);
                const double dx = column + places_[2 * cell] - x, dy = row + places_[2 * cell + 1] - y;
                sum += std::exp(-kSharp * (dx * dx + dy * dy));
            }
        return std::log(sum) / kSharp;
    }

private:
    int cells_;
    std::vector<double> places_;
};

struct ReliefMaps {
    TextureFile normal;
    TextureFile occlusionRoughness; ///< occlusion in red, roughness in green, as glTF packs them
};

/// The maps of a relief over a tile that repeats. `height(u, v)` in tiles. A groove is as dark as it lies below its
/// surroundings, `reach` tiles wide; it is `wet` rough where it is deep and `dry` where it is high.
template <class Height>
ReliefMaps reliefMaps(const std::string& name, int size, double reach, double dry, double wet, Height&& height)
{
    std::vector<double> heights;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) heights.push_back(height((x + 0.5) / size, (y + 0.5) / size));
    const auto at = [&](int x, int y) {
        return heights[std::size_t((y + size) % size) * std::size_t(size) + std::size_t((x + size) % size)];
    };
    const int around = std::max(1, int(std::lround(reach * size)));
    double low = heights[0], high = low;
    for (double h : heights) {
        low = std::min(low, h);
        high = std::max(high, h);
    }
    const auto pixel = [&](double u) { return int(std::floor(u * size)); };
    ReliefMaps maps;
    maps.normal = pictureFile(name + "_normal", size, [&](double u, double v) {
        const int x = pixel(u), y = pixel(v);
        return normalTexel(0.5 * size * (at(x - 1, y) - at(x + 1, y)), 0.5 * size * (at(x, y - 1) - at(x, y + 1)), 1.0);
    });
    maps.occlusionRoughness = pictureFile(name + "_orm", size, [&](double u, double v) {
        const int x = pixel(u), y = pixel(v);
        // The mean slope up to the horizon in eight directions.
        double slope = 0.0;
        for (const auto& [dx, dy] : {std::pair{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}) {
            double steepest = 0.0;
            for (int i = 1; i <= around; ++i)
                steepest =
                    std::max(steepest, (at(x + i * dx, y + i * dy) - at(x, y)) * size / (i * std::hypot(dx, dy)));
            slope += std::atan(steepest) / 8.0;
        }
        const double open = std::pow(std::cos(slope), 2.0); // what a cosine-weighted sky leaves of itself
        const double share = (at(x, y) - low) / std::max(high - low, 1e-12);
        return std::array{open, wet + (dry - wet) * share, 0.0};
    });
    return maps;
}

} // namespace filasofia::visual
