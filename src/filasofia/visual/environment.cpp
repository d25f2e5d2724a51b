#include "filasofia/visual/environment.h"

#include <cmath>
#include <numbers>

namespace filasofia::visual {
namespace {

Vec3 rgb(const Color& c) { return {c.red, c.green, c.blue}; }

// Around its axis a lobe falls as exp(sharpness (cos - 1)); this is its integral over all directions.
double lobeIntegral(double sharpness)
{
    return 2.0 * std::numbers::pi * (1.0 - std::exp(-2.0 * sharpness)) / sharpness;
}

/// The direction of a texel's centre, by the table of the OpenGL specification (8.13).
Vec3 texelDirection(int face, double s, double t)
{
    switch (face) {
    case 0:
        return normalized(Vec3{1, -t, -s});
    case 1:
        return normalized(Vec3{-1, -t, s});
    case 2:
        return normalized(Vec3{s, 1, t});
    case 3:
        return normalized(Vec3{s, -1, -t});
    case 4:
        return normalized(Vec3{s, -t, 1});
    default:
        return normalized(Vec3{-s, -t, -1});
    }
}

} // namespace

Float3 radiance(const EnvironmentDef& def, Vec3 direction, double roughness)
{
    // The mirror lobe of GGX at normal incidence is nearly a spherical Gaussian of sharpness 1 / (2 alpha^2) (Wang et
    // al., "All-Frequency Rendering of Dynamic, Spatially-Varying Reflectance", 2009). A Gaussian lamp blurred by a
    // Gaussian is again a Gaussian, wider and with the same integral: no sampling is needed.
    const double alpha = std::max(roughness * roughness, 1e-3);
    const double blur = 1.0 / (2.0 * alpha * alpha);
    const double sharp = 1.0 / (def.lampSize * def.lampSize);
    const double wide = sharp * blur / (sharp + blur);
    const double peak = def.lampStrength * lobeIntegral(sharp) / lobeIntegral(wide);
    const double lamp = peak * std::exp(wide * (dot(direction, normalized(def.lampDirection)) - 1.0));

    // Linear from below to above; a blur scales the linear part by the lobe's mean cosine.
    const double mean = 1.0 / std::tanh(blur) - 1.0 / blur;
    const double up = 0.5 + 0.5 * mean * direction.y;
    return toFloat3((1.0 - up) * rgb(def.below) + up * rgb(def.above) + lamp * rgb(def.lamp));
}

std::vector<Float3> reflectionCube(const EnvironmentDef& def, int size, double roughness)
{
    std::vector<Float3> texels;
    texels.reserve(6 * std::size_t(size) * std::size_t(size));
    const auto coordinate = [&](int i) { return (2.0 * i + 1.0) / size - 1.0; };
    for (int face = 0; face < 6; ++face)
        for (int row = 0; row < size; ++row)
            for (int column = 0; column < size; ++column)
                texels.push_back(radiance(def, texelDirection(face, coordinate(column), coordinate(row)), roughness));
    return texels;
}

std::array<Float3, 9> irradianceHarmonics(const EnvironmentDef& def)
{
    // The basis without its constants. The constants of projection, cosine convolution, Lambert's 1/pi and
    // reconstruction, squared if they appear twice, are combined into one factor per function (Ramamoorthi and Hanrahan
    // 2001, and the table beside IndirectLight::Builder::irradiance).
    constexpr double kPi = std::numbers::pi;
    const auto basis = [](Vec3 d) -> std::array<double, 9> {
        return {1.0, d.y, d.z, d.x, d.x * d.y, d.y * d.z, 3.0 * d.z * d.z - 1.0, d.z * d.x, d.x * d.x - d.y * d.y};
    };
    constexpr std::array<double, 9> kConstant = {0.282095, 0.488603, 0.488603, 0.488603, 1.092548,
                                                 1.092548, 0.315392, 1.092548, 0.546274};
    const auto cosine = [](std::size_t i) { return i == 0 ? 1.0 : i < 4 ? 2.0 / 3.0 : 0.25; };

    constexpr int kRows = 64, kColumns = 128;
    std::array<Vec3, 9> sums{};
    for (int row = 0; row < kRows; ++row) {
        const double polar = (row + 0.5) * kPi / kRows;
        for (int column = 0; column < kColumns; ++column) {
            const double around = (column + 0.5) * 2.0 * kPi / kColumns;
            const Vec3 d{std::sin(polar) * std::cos(around), std::cos(polar), std::sin(polar) * std::sin(around)};
            const double solidAngle = std::sin(polar) * (kPi / kRows) * (2.0 * kPi / kColumns);
            const Float3 light = radiance(def, d, 0.0);
            const std::array<double, 9> y = basis(d);
            for (std::size_t i = 0; i < 9; ++i) sums[i] += solidAngle * y[i] * Vec3{light.x, light.y, light.z};
        }
    }
    std::array<Float3, 9> harmonics;
    for (std::size_t i = 0; i < 9; ++i) harmonics[i] = toFloat3(kConstant[i] * kConstant[i] * cosine(i) * sums[i]);
    return harmonics;
}

} // namespace filasofia::visual
