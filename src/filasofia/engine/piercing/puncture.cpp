#include "filasofia/engine/piercing/channels.h"

#include "filasofia/core/log.h"
#include "filasofia/engine/contact/attachment_points.h"
#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/contact/pinned_contacts.h"
#include "filasofia/engine/piercing/embed.h"
#include "filasofia/engine/piercing/threading.h"
#include "filasofia/engine/scene/find_body.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

namespace filasofia::engine {
namespace {

/// A tip that pushes at the surface of tissue.
struct Push {
    BodyId needle, tissue;
    Vec3 force = {};        ///< [N] on the tissue, in this step
    double strongest = 0.0; ///< [N] the largest of its contacts
    BodyPoint place = {};   ///< in the tissue, where that one is
};

bool isNeedle(const Scene& scene, BodyId id)
{
    const auto place = findBody(scene, id);
    if (!place) return false;
    if (!place->soft) return scene.rigid[place->index].model.needle.has_value();
    const Rod& rod = scene.soft[place->index].model.rod;
    return rod.needle && !isCut(rod, 0); // a tip of one node has no direction
}

bool hasNeedle(const Scene& scene, BodyId id, const BodyPoint& point, const RigidPlan& plan)
{
    if (!isNeedle(scene, id)) return false;
    const BodyPlace place = *findBody(scene, id);
    return place.soft || (point.of == BodyPoint::Of::Rigid &&
                          plan[point.body].element == scene.rigid[place.index].model.needle->element);
}

bool canBePierced(const Scene& scene, BodyId id)
{
    const auto place = findBody(scene, id);
    return place && place->soft && scene.soft[place->index].model.puncture;
}

/// Whether the needle is already on its way through the tissue.
bool isInside(const Scene& scene, BodyId needle, BodyId tissue)
{
    return std::ranges::any_of(scene.channels, [&](const Channel& each) {
        return each.tissue == tissue && each.lines.front().body == needle && !each.through;
    });
}

/// [m] The distance of points at which tissue holds a needle: that of its Def; for a rod the length of an edge.
double spacingOf(const Scene& scene, BodyId needle)
{
    const BodyPlace place = *findBody(scene, needle);
    if (!place.soft) return scene.rigid[place.index].model.needle->spacing;
    return scene.soft[place.index].model.rod.edges.front().restLength;
}

/// The side of a contact that is a tip at tissue which it may pierce; none if neither is.
std::optional<std::size_t> sideOfTip(const Constraint& contact, const Scene& scene, const RigidPlan& plan)
{
    const std::array<BodyId, 2> bodies{contact.contact.cached.first, contact.contact.cached.second};
    for (const std::size_t side : {0, 1}) {
        const BodyId needle = bodies[side], tissue = bodies[1 - side];
        const BodyPoint& point = contact.sides[side];
        if (!hasNeedle(scene, needle, point, plan) || !canBePierced(scene, tissue)) continue;
        if (isInside(scene, needle, tissue)) continue;
        const LineShape line(scene, {needle});
        if (point.of == BodyPoint::Of::Soft && !line.hasNode(point.nodes[0])) continue;
        if (line.nearest(point.position) <= 2.0 * line.radius() + contact.contact.proximity) return side;
    }
    return std::nullopt;
}

/// What the tips push at, from the contacts of the step.
std::vector<Push> pushes(double dt, const Coupling& coupling, const Scene& scene)
{
    std::vector<Push> found;
    for (const Constraint& contact : coupling.contacts()) {
        if (!(contact.impulse.x > 0.0)) continue;
        const auto side = sideOfTip(contact, scene, coupling.rigid);
        if (!side) continue;
        const std::array<BodyId, 2> bodies{contact.contact.cached.first, contact.contact.cached.second};
        const BodyId needle = bodies[*side], tissue = bodies[1 - *side];
        const Vec3 force = (*side == 0 ? -1.0 : 1.0) / dt * inWorld(contact.frame, contact.impulse);
        auto at = std::ranges::find_if(
            found, [&](const Push& each) { return each.needle == needle && each.tissue == tissue; });
        if (at == found.end()) at = found.insert(at, {.needle = needle, .tissue = tissue});
        at->force += force;
        if (!(length(force) > at->strongest)) continue;
        at->strongest = length(force);
        at->place = contact.sides[1 - *side];
    }
    return found;
}

void beginChannel(BodyId tissue, BodyId needle, std::vector<NodeWeight> entry, Scene& scene)
{
    const std::vector<Vec3>& x = scene.soft[findBody(scene, tissue)->index].state.x;
    const LineShape line(scene, {needle});
    Channel channel{
        .tissue = tissue, .spacing = spacingOf(scene, needle), .lines = {{needle}}, .points = {}, .end = entry};
    const double held = line.nearest(meanOf(entry, x), 0.0);
    channel.points.push_back({.nodes = std::move(entry), .held = held});
    scene.channels.push_back(std::move(channel));
}

/// Where a line goes into a surface, nearest to the line's front, but not in the front itself.
struct Entry {
    double place = std::numeric_limits<double>::infinity(); ///< [m] on the line
    geometry::Triangle triangle = {};
};
Entry entryOf(const LineShape& line, const SoftBody& tissue)
{
    constexpr double kAlong = 2.0; // radii by which a tip may be in a surface that it has not pierced
    const std::vector<Vec3>& x = tissue.state.x;
    const auto at = [&](int node) { return x[static_cast<std::size_t>(node)]; };
    Entry out;
    for (std::size_t s = 0; s < line.segments(); ++s) {
        const auto [front, back] = line.segment(s);
        const Vec3 from = line.position(front), along = line.position(back) - from;
        for (const geometry::Triangle& triangle : tissue.model.surface) {
            const Vec3 a = at(triangle[0]), b = at(triangle[1]), c = at(triangle[2]);
            if (!(dot(cross(b - a, c - a), along) > 0.0)) continue; // it comes out, or the node is of no surface
            const double part = geometry::rayTriangle(from, along, a, b, c);
            const double place = front + part * (back - front);
            if (part <= 1.0 && place > kAlong * line.radius() && place < out.place) out = {place, triangle};
        }
        if (std::isfinite(out.place)) break;
    }
    return out;
}

/// A tip that slipped through a surface, between the nodes of soft tissue or beside them, has pierced it, too: else
/// nothing would hold it, and nobody would know.
void pierceIfSlipped(BodyId needle, BodyId tissue, Scene& scene)
{
    if (!isNeedle(scene, needle) || !canBePierced(scene, tissue) || isInside(scene, needle, tissue)) return;
    const SoftBody& body = scene.soft[findBody(scene, tissue)->index];
    const std::vector<Vec3>& x = body.state.x;
    const LineShape line(scene, {needle});
    const Entry entry = entryOf(line, body);
    if (!std::isfinite(entry.place)) return;
    const Vec3 place = line.position(entry.place);
    const bool known = std::ranges::any_of(scene.channels, [&](const Channel& channel) {
        return channel.tissue == tissue && distanceToPath(channel, place, x) < 2.0 * line.radius() + channel.spacing;
    });
    if (known) return;
    std::vector<NodeWeight> near;
    for (const int node : entry.triangle) near.push_back({node, 1.0 / 3.0});
    auto nodes = embedNearest(place, near, body.model, x);
    if (!nodes) return;
    logWarning("the tip of ", nameOf(scene, needle), " slipped through the surface of ", nameOf(scene, tissue),
               " with less than the ", body.model.puncture->force, " N that pierce it: it counts as pierced");
    beginChannel(tissue, needle, std::move(*nodes), scene);
}

} // namespace

void yieldToTips(double dt, const Scene& scene, Coupling& coupling)
{
    for (Constraint& contact : coupling.contacts()) {
        if (contact.softness > 0.0) continue; // a penalty yields
        const auto moves = [&](const BodyPoint& point) { return canMove(point, scene, coupling.rigid); };
        if (std::ranges::any_of(contact.sides, moves)) continue;
        const auto side = sideOfTip(contact, scene, coupling.rigid);
        if (!side) continue;
        const std::array<BodyId, 2> bodies{contact.contact.cached.first, contact.contact.cached.second};
        const PunctureModel& law = *scene.soft[findBody(scene, bodies[1 - *side])->index].model.puncture;
        yieldAsSpring(dt, law.force / LineShape(scene, {bodies[*side]}).radius(), contact);
        contact.contact.passing = true; // what a spring carries is no start for a contact that does not yield
    }
}

void puncture(double dt, const Coupling& coupling, Scene& scene)
{
    if (dt == 0.0) return;
    for (const Push& push : pushes(dt, coupling, scene)) {
        const SoftBody& tissue = scene.soft[findBody(scene, push.tissue)->index];
        const LineShape needle(scene, {push.needle});
        if (!(dot(push.force, needle.forward(0.0)) >= tissue.model.puncture->force)) continue;
        const std::vector<NodeWeight> touched = nodeWeights(push.place);
        const std::vector<Vec3>& x = tissue.state.x;
        auto entry = embedNearest(meanOf(touched, x), touched, tissue.model, x);
        if (entry) beginChannel(push.tissue, push.needle, std::move(*entry), scene);
    }
    for (const physics::Intersection& each : coupling.detection.intersections.told) {
        if (each.cause == physics::IntersectionCause::Start || each.first == each.second) continue;
        pierceIfSlipped(each.first, each.second, scene);
        pierceIfSlipped(each.second, each.first, scene);
    }
}

} // namespace filasofia::engine
