#include "filasofia/engine/rupture/elements_at.h"

#include "filasofia/engine/rupture/tet_shape.h"
#include "filasofia/geometry/box.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace filasofia::engine {
namespace {

// [m] The walls of a cut lie on the blade up to rounding, or a skin of 10 um apart if they collide with each other; at
// this distance their sides are certain.
constexpr double kTouching = 20e-6;
constexpr double kMoreElements = 1.5; // [-]
constexpr int kFewElements = 8;

std::pair<double, double> shadow(std::span<const Vec3> points, Vec3 axis)
{
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec3& point : points) {
        const double at = dot(axis, point);
        low = std::min(low, at);
        high = std::max(high, at);
    }
    return {low, high};
}

/// Whether a plane across the axis has one body on each side, further apart than the margin.
bool parts(std::span<const Vec3> a, std::span<const Vec3> b, Vec3 axis, double margin)
{
    const double size = length(axis);
    if (!(size > 0.0)) return false;
    const auto [lowA, highA] = shadow(a, axis);
    const auto [lowB, highB] = shadow(b, axis);
    return std::max(lowA - highB, lowB - highA) > margin * size;
}

/// Per point one bit for each side of a box that it is beyond (Cohen and Sutherland): the box around points overlaps
/// this one unless all of them have a bit in common.
std::vector<std::uint8_t> sidesBeyond(const geometry::Box& box, std::span<const Vec3> points)
{
    std::vector<std::uint8_t> out;
    out.reserve(points.size());
    for (const Vec3& p : points)
        out.push_back(static_cast<std::uint8_t>((p.x < box.low.x) | (p.x > box.high.x) << 1 | (p.y < box.low.y) << 2 |
                                                (p.y > box.high.y) << 3 | (p.z < box.low.z) << 4 |
                                                (p.z > box.high.z) << 5));
    return out;
}

} // namespace

bool isPushedOn(const ElementsAtBlade& now, int sheath)
{
    return sheath > 0 && now.inside > kMoreElements * (sheath - 1) + kFewElements;
}

ElementsAtBlade elementsAt(const std::vector<Vec3>& corners, const ElementsToTest& elements,
                           const std::vector<Vec3>& places)
{
    const std::span<const Vec3> all(corners);
    const geometry::Box around = geometry::grown(geometry::boxAround(all), kTouching);
    const std::vector<std::uint8_t> beyond = sidesBeyond(around, places);
    ElementsAtBlade count;
    for (std::size_t e = 0; e < elements.count; ++e) {
        const geometry::Tetrahedron nodes = elements.nodes(e);
        std::uint8_t common = 0x3f;
        for (const int node : nodesOf(nodes)) common &= beyond[static_cast<std::size_t>(node)];
        if (common != 0 || elements.isLeftOut(e)) continue;
        std::array<Vec3, 4> at{};
        std::size_t n = 0;
        for (const int node : nodesOf(nodes)) at[n++] = places[static_cast<std::size_t>(node)];
        const std::span<const Vec3> element(at.data(), n);
        bool near = false, inside = false;
        for (std::size_t t = 0; t + 2 < corners.size() && !inside; t += 3) {
            const std::span<const Vec3> triangle = all.subspan(t, 3);
            near = near || isNear(triangle, element, kTouching);
            inside = near && isNear(triangle, element, -kTouching);
        }
        count += {near, inside};
    }
    return count;
}

bool isNear(std::span<const Vec3> triangle, std::span<const Vec3> element, double margin)
{
    const auto apart = [&](Vec3 axis) { return parts(triangle, element, axis, margin); };
    const auto edge = [](std::span<const Vec3> of, std::size_t i, std::size_t j) { return of[j] - of[i]; };
    if (apart(cross(edge(triangle, 0, 1), edge(triangle, 0, 2)))) return false;
    const std::size_t n = element.size();
    for (std::size_t skip = 0; skip < (n == 4 ? 4 : 1); ++skip) { // the faces
        const std::size_t a = (skip + 1) % n, b = (skip + 2) % n;
        if (apart(cross(edge(element, a, b), edge(element, a, n == 4 ? (skip + 3) % n : skip)))) return false;
    }
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = i + 1; j < n; ++j)
                if (apart(cross(edge(triangle, k, (k + 1) % 3), edge(element, i, j)))) return false;
    return true;
}

} // namespace filasofia::engine
