#include "filasofia/engine/contact/sheathed_blades.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/geometry/box.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace filasofia::engine {
namespace {

// [m] The walls of a cut lie on the blade up to rounding; at this distance their sides are certain.
constexpr double kTouching = 20e-6;
// [-] Tissue moves around a sheathed blade, and so do the elements that it is in. More than that is a push.
constexpr double kMoreElements = 1.5;
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

/// The world's places of a blade's triangles, three by three.
std::vector<Vec3> bladeCorners(const RigidBody& body, const CollisionModel& blade)
{
    std::vector<Vec3> corners;
    const Pose& pose = body.state.poses[static_cast<std::size_t>(blade.element)];
    for (const geometry::Triangle& triangle : blade.shape->triangles)
        for (const int vertex : triangle)
            corners.push_back(transform(pose, blade.shape->rest[static_cast<std::size_t>(vertex)]));
    return corners;
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

int elementsAt(const std::vector<Vec3>& corners, const SoftBody& body)
{
    const std::span<const Vec3> all(corners);
    const geometry::Box around = geometry::grown(geometry::boxAround(all), kTouching);
    const std::vector<std::uint8_t> beyond = sidesBeyond(around, body.state.x);
    int count = 0;
    for (std::size_t e = 0; e < elementCount(body.model); ++e) {
        const geometry::Tetrahedron nodes = elementNodes(body.model, e);
        std::uint8_t common = 0x3f;
        for (const int node : nodesOf(nodes)) common &= beyond[static_cast<std::size_t>(node)];
        if (common != 0 || allHeld(body.model, e)) continue;
        std::array<Vec3, 4> places{};
        std::size_t n = 0;
        for (const int node : nodesOf(nodes)) places[n++] = body.state.x[static_cast<std::size_t>(node)];
        const std::span<const Vec3> element(places.data(), n);
        for (std::size_t t = 0; t + 2 < corners.size(); t += 3)
            if (isNear(all.subspan(t, 3), element, kTouching)) {
                ++count;
                break;
            }
    }
    return count;
}

} // namespace

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

int elementsAtBlades(const Scene& scene, const RigidBody& body)
{
    int count = 0;
    for (const CollisionModel& each : body.model.collision) {
        if (!each.shape->cutting) continue;
        const std::vector<Vec3> corners = bladeCorners(body, each);
        for (const SoftBody& soft : scene.soft)
            if (!isRod(soft.model) && mayBeCut(soft.model, each.shape->group)) count += elementsAt(corners, soft);
    }
    return count;
}

void followSheaths(Scene& scene, physics::TopologyReport& report)
{
    for (RigidBody& body : scene.rigid) {
        if (body.state.sheath == 0) continue;
        const int now = elementsAtBlades(scene, body);
        if (now == 0) body.state.sheath = 0;
        if (now > kMoreElements * body.state.sheath + kFewElements) ++report.bladeOff;
    }
}

} // namespace filasofia::engine
