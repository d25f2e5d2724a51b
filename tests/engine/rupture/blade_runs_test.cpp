#include "filasofia/engine/rupture/blade_runs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace blade_runs_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kEdge = 3e-3; ///< [m] the mean edge

/// The sides of a polygon in the plane y = 0, each second one turned around, in the order of `order`.
std::vector<BladeSegment> ringOf(const std::vector<Vec3>& corners, const std::vector<int>& order)
{
    std::vector<BladeSegment> blade;
    for (int i : order) {
        Vec3 a = corners[static_cast<std::size_t>(i)], b = corners[(static_cast<std::size_t>(i) + 1) % corners.size()];
        if (i % 2 == 1) std::swap(a, b);
        blade.push_back({.from = a, .to = b, .fromBefore = a, .toBefore = b});
    }
    return blade;
}

std::vector<Vec3> circle(int sides, double radius)
{
    std::vector<Vec3> corners;
    for (int i = 0; i < sides; ++i) {
        const double a = 2.0 * std::numbers::pi * i / sides;
        corners.push_back({radius * std::cos(a), 0.0, radius * std::sin(a)});
    }
    return corners;
}

void move(std::vector<BladeSegment>& blade, Vec3 way)
{
    for (BladeSegment& s : blade) {
        s.fromBefore = s.from, s.toBefore = s.to;
        s.from += way, s.to += way;
    }
}

} // namespace

TEST_CASE("the segments of a ring are one run in any order, with one side inwards all around")
{
    std::vector<BladeSegment> blade = ringOf(circle(6, 0.01), {3, 0, 5, 2, 4, 1});
    BladeRuns runs;
    runs.join(blade, 1, kEdge);
    move(blade, {0, -1e-3, 0});
    runs.follow(blade, {}, kEdge);
    int inwards = 0;
    for (int i = 0; i < 6; ++i) {
        CHECK(runs.run(i) == runs.run(0));
        for (int end : {0, 1}) CHECK(runs.joint(i, end).segment >= 0);
        const BladeSegment& s = blade[static_cast<std::size_t>(i)];
        const Vec3 normal = runs.along(i) * cross(s.to - s.from, runs.direction(i));
        inwards += dot(normal, s.from) < 0.0 ? 1 : 0;
    }
    CHECK((inwards == 0 || inwards == 6));
    // Places are as far from each other as the unrolled ring is, the shorter way around.
    const double side = 0.01; // a hexagon's
    for (int i = 1; i < 6; ++i) {
        const double apart = runs.distanceBetween(runs.placeAt(0, 0.5, 0.5), runs.placeAt(i, 0.5, 0.5));
        CHECK(std::abs(apart / side - std::round(apart / side)) < 1e-9);
        CHECK(apart < 3.5 * side);
    }
    runs.setSideAt(runs.placeAt(2, 0.5, 0.5), -1);
    for (int i = 0; i < 6; ++i) CHECK(runs.sideAt(runs.placeAt(i, 0.1, 1.0)) == -1);
}

TEST_CASE("the rim of a strip that is narrow for the tissue is no ring: each side cuts by itself, and knows no places")
{
    const auto strip = [](double width) {
        return ringOf({{0, 0, 0}, {0.02, 0, 0}, {0.02, 0, width}, {0, 0, width}}, {0, 1, 2, 3});
    };
    for (const double width : {0.2 * kEdge, 0.9 * kEdge, 2.0 * kEdge}) {
        CAPTURE(width);
        std::vector<BladeSegment> blade = strip(width);
        BladeRuns runs;
        runs.join(blade, 1, kEdge);
        move(blade, {0, -1e-3, 0});
        runs.follow(blade, {}, kEdge);
        const bool wide = width > 1.9 * kEdge;
        for (int i = 0; i < 4; ++i) {
            CHECK((runs.joint(i, 0).segment >= 0) == wide);
            CHECK((runs.placeAt(i, 0.5, 0.5).pass > 0) == wide);
            CHECK((runs.run(i) == runs.run(0)) == (wide || i == 0));
        }
    }
}

TEST_CASE("after a pause a ring keeps its sides, and another part of its body has none")
{
    std::vector<BladeSegment> blade = ringOf(circle(8, 0.01), {0, 1, 2, 3, 4, 5, 6, 7});
    BladeRuns runs;
    runs.join(blade, 1, kEdge);
    move(blade, {0, -1e-3, 0});
    runs.follow(blade, {}, kEdge);
    const SweptPlace before = runs.placeAt(3, 0.5, 0.5);
    runs.setSideAt(before, 1);
    runs.join(blade, 2, kEdge);
    CHECK(runs.sideAt(before) == 0); // another pass
    CHECK(runs.sideAt(runs.placeAt(3, 0.5, 0.5)) == 1);
    runs.join(ringOf(circle(8, 0.02), {0, 1, 2, 3, 4, 5, 6, 7}), 3, kEdge);
    CHECK(runs.sideAt(runs.placeAt(3, 0.5, 0.5)) == 0);
}

} // namespace blade_runs_test
