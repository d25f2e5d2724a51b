#include "filasofia/engine/contact/intersections.h"

#include "filasofia/engine/collision/feature_normals.h"
#include "filasofia/engine/collision/surface_crossings.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

namespace filasofia::engine {
namespace {

// [s] Intersections last. At 1 kHz `filasofia bench contact` shows no cost of one test per 10 ms beside its spread.
constexpr double kInterval = 0.01;
// Relative to the sum of the proximities: what passes right through a wall by less may be rounding.
constexpr double kShallow = 0.05;

bool isDue(double time, double dt)
{
    // In the middle between two steps, where rounding decides nothing.
    return dt >= kInterval || std::floor((time + 0.5 * dt) / kInterval) != std::floor((time - 0.5 * dt) / kInterval);
}

/// Whether contact has lost the place: it is deeper than contacts are followed, or beyond a wall. The rim of a plate
/// that is scraped over tissue at 1 m/s passes through its surface by up to 0.85 mm and is pushed out again.
bool isLost(const SurfaceCrossing& crossing, const SurfacePair& meeting)
{
    return crossing.depth > (crossing.through ? kShallow * meeting.proximities() : meeting.depths());
}

/// Whether an attachment between two bodies holds a place on the surface of one of them. A rigid body is held as a
/// whole.
bool holds(const Attachment& attachment, const SurfaceOwner& owner, std::span<const int> vertices)
{
    if (!owner.soft) return true;
    const std::size_t side = attachment.body == owner.name.body ? 0 : 1;
    const auto isHeld = [&](int node) {
        return std::ranges::any_of(attachment.pairs, [&](const std::array<AttachedPoint, 2>& pair) {
            return std::ranges::find(pair[side].nodes, node, &NodeWeight::node) != pair[side].nodes.end();
        });
    };
    const geometry::Embedding& embedding = owner.collision->embedding;
    return std::ranges::any_of(vertices, [&](int vertex) {
        const auto at = static_cast<std::size_t>(vertex);
        for (std::size_t k = 0; k < 4; ++k)
            if (embedding.weights[at][k] != 0.0 && isHeld(embedding.nodes[at][k])) return true;
        return false;
    });
}

std::vector<const Attachment*> attachmentsBetween(const Scene& scene, BodyId a, BodyId b)
{
    std::vector<const Attachment*> between;
    for (const Attachment& each : scene.attachments)
        if ((each.body == a && each.to == b) || (each.body == b && each.to == a)) between.push_back(&each);
    return between;
}

/// Whether one body runs through a channel in the other.
bool isPierced(const Scene& scene, BodyId a, BodyId b)
{
    return std::ranges::any_of(scene.channels, [&](const Channel& each) {
        const auto runs = [&](BodyId id) {
            return std::ranges::find(each.lines, id, &ThreadedLine::body) != each.lines.end();
        };
        return (each.tissue == a && runs(b)) || (each.tissue == b && runs(a));
    });
}

/// A vertex of a surface that lies in another, closed one, if their surfaces do not cross.
std::optional<physics::Intersection> insideOf(const CollisionSurface& inner, const CollisionSurface& outer)
{
    if (!outer.shape->closed || !outer.shape->triangleFaces) return std::nullopt;
    const Vec3 point = inner.x[static_cast<std::size_t>(inner.shape->elements.front().vertices[0])];
    const Bounds at = inner.vertexBounds[static_cast<std::size_t>(inner.shape->elements.front().vertices[0])];
    if (damaged(at) || !meet(at, outer.whole)) return std::nullopt;
    const double depth = depthInside(outer, point);
    if (!(depth > 0.0)) return std::nullopt;
    return physics::Intersection{.first = {}, .second = {}, .depth = depth, .place = point};
}

class Finder {
public:
    Finder(const StepContext& context, const Scene& scene, const std::vector<SurfaceOwner>& owners, Coupling& coupling)
        : context_(context), scene_(scene), owners_(owners), plan_(coupling.rigid), detection_(coupling.detection)
    {
    }
    void run()
    {
        detection_.intersections.clear();
        for (const std::array<int, 2>& pair : detection_.scratch.surfacePairs) test(pair);
        std::ranges::sort(detection_.intersections, {},
                          [](const physics::Intersection& each) { return std::pair(each.first, each.second); });
    }

private:
    void test(std::array<int, 2> pair)
    {
        const SurfaceOwner &one = ownerOf(pair[0]), &two = ownerOf(pair[1]);
        if (!movable(one, plan_) && !movable(two, plan_)) return; // scenery
        if (isPierced(scene_, one.name.body, two.name.body)) return;
        const CollisionSurface &a = surfaceOf(pair[0]), &b = surfaceOf(pair[1]);
        const SurfacePair meeting{{&a, &b}, pair, 0.0};
        const auto between = attachmentsBetween(scene_, one.name.body, two.name.body);
        crossings_.clear();
        findSurfaceCrossings(meeting, context_.pool, detection_.scratch, crossings_);
        for (const SurfaceCrossing& each : crossings_)
            if (isLost(each, meeting) && !isHeld(each, between))
                add(one, two, {.crossings = 1, .depth = each.depth, .place = each.place});
        if (!crossings_.empty() || meeting.self() || !between.empty()) return;
        if (const auto within = insideOf(a, b))
            add(one, two, *within);
        else if (const auto around = insideOf(b, a))
            add(one, two, *around);
    }

    /// Attached bodies may overlap at what holds them together.
    bool isHeld(const SurfaceCrossing& crossing, const std::vector<const Attachment*>& between) const
    {
        return std::ranges::any_of(between, [&](const Attachment* each) {
            return holds(*each, ownerOf(crossing.surfaces[0]), crossing.edge) ||
                   holds(*each, ownerOf(crossing.surfaces[1]), crossing.triangle);
        });
    }

    void add(const SurfaceOwner& one, const SurfaceOwner& two, physics::Intersection found)
    {
        std::tie(found.first, found.second) = std::minmax(one.name.body, two.name.body);
        for (physics::Intersection& each : detection_.intersections) {
            if (each.first != found.first || each.second != found.second) continue;
            found.crossings += each.crossings;
            if (each.depth > found.depth) found.depth = each.depth, found.place = each.place;
            each = found;
            return;
        }
        detection_.intersections.push_back(found);
    }

    const SurfaceOwner& ownerOf(int surface) const { return owners_[static_cast<std::size_t>(surface)]; }
    const CollisionSurface& surfaceOf(int surface) const
    {
        return detection_.surfaces[static_cast<std::size_t>(surface)];
    }

    const StepContext& context_;
    const Scene& scene_;
    const std::vector<SurfaceOwner>& owners_;
    const RigidPlan& plan_;
    ContactDetection& detection_;
    std::vector<SurfaceCrossing> crossings_;
};

} // namespace

void reportIntersections(const StepContext& context, const Scene& scene, const std::vector<SurfaceOwner>& owners,
                         bool changed, Coupling& coupling)
{
    if (changed || isDue(scene.time, context.dt)) Finder(context, scene, owners, coupling).run();
    context.report.intersections = coupling.detection.intersections;
    if (!context.report.intersections.empty()) context.report.set(physics::StepFlag::Intersecting);
}

} // namespace filasofia::engine
