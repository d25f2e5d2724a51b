#include "filasofia/surface/lumen.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

namespace filasofia::surface {
namespace {

constexpr double kFits = 1.2;   // [-] so much wider or narrower than the wall a ring may be: twice the flow
constexpr double kWalled = 0.7; // [-] part of the ways from a middle outwards that must meet a wall

// [-] A path that is looked along misses the edges of the mesh, which may lie as regularly as the rings do.
constexpr double kAside = 0.137;

/// What is around a place on a path.
struct Wall {
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0.0; ///< [m] from the place
    bool hollow = false;                                                      ///< the place is not in tissue
};

/// How many times a ring is too wide or too narrow; at most 1 if it fits. A lumen that is not round has a radius
/// between its smallest and its largest half width.
double misfit(double radius, const Wall& wall)
{
    return std::max(radius / wall.farthest, wall.hollow ? wall.nearest / radius : 0.0);
}

} // namespace

void checkRadius(double radius, const Rings& rings, const geometry::TetMesh& mesh,
                 std::span<const geometry::Triangle> skin, const std::string& object)
{
    const auto corner = [&](int triangle, std::size_t k) {
        return mesh.nodes[static_cast<std::size_t>(skin[static_cast<std::size_t>(triangle)][k])];
    };
    std::vector<geometry::Box> boxes;
    for (int t = 0; t < static_cast<int>(skin.size()); ++t) {
        boxes.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) boxes.back() = geometry::merged(boxes.back(), corner(t, k));
    }
    const geometry::Bvh tree(boxes);
    const std::size_t around = rings.points.size() / rings.middles.size();
    const auto wallAround = [&](std::size_t s) -> std::optional<Wall> {
        Wall wall;
        std::size_t met = 0, entered = 0;
        for (std::size_t i = 0; i < around; ++i) {
            const Vec3 middle = rings.middles[s], next = rings.points[around * s + (i + 1) % around];
            const Vec3 point = (1.0 - kAside) * rings.points[around * s + i] + kAside * next;
            const Vec3 from = middle + kAside * kAside * (rings.middles[s > 0 ? s - 1 : 1] - middle);
            const Vec3 out = normalized(point - middle);
            const auto hit = tree.firstHit(from, out, [&](int t) {
                return geometry::rayTriangle(from, out, corner(t, 0), corner(t, 1), corner(t, 2));
            });
            if (hit.primitive < 0) continue;
            const int t = hit.primitive;
            ++met;
            entered += dot(cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)), out) < 0.0;
            wall.nearest = std::min(wall.nearest, hit.value);
            wall.farthest = std::max(wall.farthest, hit.value);
        }
        if (static_cast<double>(met) < kWalled * static_cast<double>(around) || wall.farthest == 0.0) return {};
        wall.hollow = 2 * entered > met;
        return wall;
    };
    std::optional<Wall> best;
    for (std::size_t s = 0; s < rings.middles.size(); ++s)
        if (const auto wall = wallAround(s); wall && (!best || misfit(radius, *wall) < misfit(radius, *best)))
            best = wall;
    if (best && misfit(radius, *best) > kFits)
        fail(object, ": radius must be that of a tube through the body, whose wall is ", best->nearest, " to ",
             best->farthest, " m away from the path where it fits best, got ", radius, " m");
}

} // namespace filasofia::surface
