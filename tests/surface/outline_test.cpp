#include "filasofia/surface/outline.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

namespace outline_test {
using namespace filasofia::surface;

TEST_CASE("a polygon has the area and the second moments of the closed forms, wherever it lies")
{
    for (const double at : {0.0, 3.0}) {
        const AreaMoments m =
            momentsOf({{at, at}, {at + 4, at}, {at + 4, at + 2}, {at, at + 2}}); // w^3 h / 12, w h^3 / 12
        CHECK(m.area == Approx(8));
        CHECK(m.xx == Approx(64 * 2 / 12.0));
        CHECK(m.yy == Approx(4 * 8 / 12.0));
        CHECK(m.xy == Approx(0).margin(1e-9));
    }
    const AreaMoments turned = momentsOf({{0, 0}, {0, 2}, {4, 2}, {4, 0}}); // clockwise
    CHECK(turned.area == Approx(-8));
    const double a = 2.0, b = 0.5, angle = 0.7; // an ellipse: a^2 / 4 and b^2 / 4 times its area
    Outline ellipse;
    for (int i = 0; i < 400; ++i) {
        const double t = 2.0 * std::numbers::pi * i / 400, x = a * std::cos(t), y = b * std::sin(t);
        ellipse.push_back({x * std::cos(angle) - y * std::sin(angle), x * std::sin(angle) + y * std::cos(angle)});
    }
    const AreaMoments m = momentsOf(ellipse);
    CHECK(m.area == Approx(std::numbers::pi * a * b).epsilon(1e-3));
    CHECK(m.xx + m.yy == Approx(m.area * (a * a + b * b) / 4).epsilon(1e-3));
    CHECK(std::hypot(m.xx - m.yy, 2 * m.xy) == Approx(m.area * (a * a - b * b) / 4).epsilon(1e-3));
}

TEST_CASE("an outline is cut where it crosses itself, and each lobe keeps its sense")
{
    const Outline square{{0, 0}, {2, 0}, {2, 2}, {0, 2}};
    CHECK_FALSE(crossesItself(square));
    CHECK(lobesOf(square) == std::vector<Outline>{square});
    const Outline eight{{0, 0}, {2, 2}, {2, 0}, {0, 2}}; // two triangles of area 1, one of them clockwise
    CHECK(crossesItself(eight));
    std::vector<Outline> lobes = lobesOf(eight);
    REQUIRE(lobes.size() == 2);
    CHECK(momentsOf(lobes[0]).area * momentsOf(lobes[1]).area == Approx(-1));
    // Three lobes in a row: the middle one goes the other way round.
    const Outline chain{{0, 0}, {1, 0.5}, {2, -0.5}, {3, 0.5}, {4, 0}, {3, -0.5}, {2, 0.5}, {1, -0.5}};
    lobes = lobesOf(chain);
    REQUIRE(lobes.size() == 3);
    double sum = 0.0, all = 0.0;
    for (const Outline& each : lobes) sum += momentsOf(each).area, all += std::abs(momentsOf(each).area);
    CHECK(sum == Approx(-1.0));
    CHECK(all == Approx(2.0));
}

} // namespace outline_test
