#include "filasofia/visual/environment.h"

#include <numbers>

namespace environment_test {

using namespace filasofia;
using namespace filasofia::visual;

namespace {

/// The diffuse light on a surface with this normal, as Filament's shader evaluates the harmonics.
double diffuse(const std::array<Float3, 9>& sh, Vec3 n)
{
    return sh[0].x + sh[1].x * n.y + sh[2].x * n.z + sh[3].x * n.x + sh[4].x * n.y * n.x + sh[5].x * n.y * n.z +
           sh[6].x * (3.0 * n.z * n.z - 1.0) + sh[7].x * n.z * n.x + sh[8].x * (n.x * n.x - n.y * n.y);
}

/// The same by quadrature: the cosine-weighted mean of the radiance.
double diffuseByQuadrature(const EnvironmentDef& def, Vec3 n)
{
    double sum = 0.0;
    constexpr int kRows = 200, kColumns = 400;
    for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column) {
            const double polar = (row + 0.5) * std::numbers::pi / kRows;
            const double around = (column + 0.5) * 2 * std::numbers::pi / kColumns;
            const Vec3 d{std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)};
            sum += radiance(def, d, 0.0).x * std::max(dot(n, d), 0.0) * std::sin(polar);
        }
    return sum * 2 * std::numbers::pi / (kRows * kColumns);
}

} // namespace

TEST_CASE("the harmonics of even surroundings are even")
{
    EnvironmentDef def;
    def.above = def.below = {0.5, 0.5, 0.5};
    def.lampStrength = 0.0;
    const auto sh = irradianceHarmonics(def);
    CHECK(sh[0].x == Approx(0.5).epsilon(1e-3));
    for (std::size_t i = 1; i < 9; ++i) CHECK(std::abs(sh[i].x) < 1e-3);
}

TEST_CASE("the harmonics give the diffuse light of a wide lamp")
{
    EnvironmentDef def;
    def.lampSize = 0.8;
    def.lampStrength = 2.0;
    def.lampDirection = {0.6, -0.3, 0.5};
    const auto sh = irradianceHarmonics(def);
    for (Vec3 n : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{0, -1, 0}, normalized(def.lampDirection)})
        CHECK(diffuse(sh, n) == Approx(diffuseByQuadrature(def, n)).epsilon(0.05));
}

TEST_CASE("a rough surface mirrors the lamp wider and dimmer, but not less of it")
{
    EnvironmentDef def;
    def.above = def.below = {0, 0, 0};
    const Vec3 lamp = normalized(def.lampDirection);
    CHECK(radiance(def, lamp, 0.0).x == Approx(def.lampStrength * def.lamp.red).epsilon(1e-3));
    double last = radiance(def, lamp, 0.0).x;
    for (double roughness : {0.25, 0.5, 0.75, 1.0}) {
        const double now = radiance(def, lamp, roughness).x;
        CHECK(now < last);
        last = now;
    }
    for (double roughness : {0.0, 0.5, 1.0}) {
        double sent = 0.0;
        constexpr int kSize = 64;
        const auto cube = reflectionCube(def, kSize, roughness);
        REQUIRE(cube.size() == 6u * kSize * kSize);
        for (int i = 0; i < kSize * kSize * 6; ++i) {
            const double s = (2.0 * (i % kSize) + 1) / kSize - 1, t = (2.0 * (i / kSize % kSize) + 1) / kSize - 1;
            sent += cube[std::size_t(i)].x * std::pow(1 + s * s + t * t, -1.5) * 4.0 / (kSize * kSize);
        }
        const double peak = def.lampStrength * def.lamp.red;
        CHECK(sent == Approx(2 * std::numbers::pi * peak * def.lampSize * def.lampSize).epsilon(0.02));
    }
}

} // namespace environment_test
