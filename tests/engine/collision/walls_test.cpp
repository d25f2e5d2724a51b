#include "engine/collision/pair_minima.h"
#include "engine/collision/scene.h"

#include "filasofia/engine/collision/element_pairs.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/surface.h"

#include <cmath>
#include <set>

// The two sides of a thin wall are near each other at rest, and never touch.
namespace filasofia::engine::walls_test {
namespace {

constexpr double kRadius = 4e-3, kWall = 0.6e-3;

/// A vessel along x of 24 mm, as a solid surface that meets itself.
void addVessel(Scene& scene)
{
    std::vector<Vec3> line;
    for (int i = 0; i <= 32; ++i) line.push_back({-0.012 + 0.75e-3 * i, 0, 0});
    scene.add(geometry::extractSurface(*geometry::shapes::vessel(line, kRadius, kWall, {36, 1})).mesh,
              {.proximity = 0.3e-3, .depth = 0.4e-3, .self = true});
}

/// Presses the vessel together to `height` [m] of its lumen, as between two plates.
void flatten(Scene& scene, double height, double roughness, std::mt19937& random)
{
    for (Vec3& x : scene.surfaces[0].x) {
        const double lift = std::hypot(x.y, x.z) - kRadius;
        const double turn = std::atan2(x.y, x.z);
        x.y = std::sin(turn) * (0.5 * height) + lift * std::sin(turn);
        x += randomVector(random, roughness);
    }
}

} // namespace

TEST_CASE("the two sides of a thin wall are no pair that is tested, as long as the wall is not crushed")
{
    Scene scene;
    addVessel(scene);
    scene.find();
    CHECK(scene.found.empty());
    const auto inTheMiddle = [&](int element) { // and not at a rim, where the surface bends by right angles
        const CollisionSurface& surface = scene.surfaces[0];
        return std::abs(surface.x[surface.shape->elements[element].vertices[0]].x) < 0.009;
    };
    CHECK(std::ranges::none_of(scene.scratch.elementPairs,
                               [&](const auto& pair) { return inTheMiddle(pair[0]) || inTheMiddle(pair[1]); }));
    std::size_t all = 0;
    collectElementPairs(scene.surfaces[0], scene.surfaces[0], nullptr, scene.scratch);
    for (const auto& [i, k] : scene.scratch.elementPairs) // opposite each other through the wall
        all += wallBetween(scene.surfaces[0].restPlates[i], scene.surfaces[0].restPlates[k]) > 0.5f * kWall;
    CHECK(all > 5000);
}

TEST_CASE("pairs that are left out as sides of a wall have nothing to find, and walls that are pressed together meet")
{
    std::mt19937 random(41);
    std::size_t dropped = 0, lost = 0;
    for (const double roughness : {0.0, 0.02e-3, 0.1e-3}) {
        Scene scene;
        addVessel(scene);
        const std::vector<Vec3> rest = scene.surfaces[0].x;
        for (const double height : {3e-3, 1e-3, 0.3e-3, 0.05e-3, -0.05e-3}) {
            CAPTURE(height, roughness);
            scene.surfaces[0].x = rest;
            flatten(scene, height, roughness, random);
            scene.find();
            const CollisionSurface& surface = scene.surfaces[0];
            if (height < 0.5e-3)
                CHECK(std::ranges::count_if(scene.found,
                                            [](const Proximity& each) { return std::abs(each.normal.y) > 0.9; }) > 100);
            const SurfacePair meeting{{&surface, &surface}, {0, 0}, kStepsAhead * scene.dt};
            const std::set<std::array<int, 2>> tested(scene.scratch.elementPairs.begin(),
                                                      scene.scratch.elementPairs.end());
            collectElementPairs(surface, surface, nullptr, scene.scratch);
            for (const std::array<int, 2>& pair : scene.scratch.elementPairs) {
                if (tested.contains(pair)) continue;
                if (!(wallBetween(surface.plates[pair[0]], surface.plates[pair[1]]) > 0.0f)) continue;
                ++dropped;
                lost += edgesThatMeet(meeting, pair).size();
                for (const PointMinimum& each : pointMinima(meeting, pair))
                    CHECK((each.proximity.gap < 0.0 || !each.facing || each.proximity.gap >= each.range));
            }
        }
    }
    CHECK(dropped > 50000);
    CHECK(lost == 0);
}

} // namespace filasofia::engine::walls_test
