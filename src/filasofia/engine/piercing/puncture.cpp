#include "filasofia/engine/piercing/channels.h"

#include "filasofia/engine/contact/attachment_points.h"
#include "filasofia/engine/contact/pinned_contacts.h"
#include "filasofia/engine/piercing/embed.h"
#include "filasofia/engine/piercing/threading.h"
#include "filasofia/engine/scene/find_body.h"

#include <algorithm>
#include <optional>
#include <span>

namespace filasofia::engine {
namespace {

/// A tip that pushes at the surface of tissue.
struct Push {
    BodyId needle, tissue;
    Vec3 force = {};        ///< [N] on the tissue, in this step
    double strongest = 0.0; ///< [N] the largest of its contacts
    BodyPoint place = {};   ///< in the tissue, where that one is
};

bool hasNeedle(const Scene& scene, BodyId id, const BodyPoint& point, const RigidPlan& plan)
{
    const auto place = findBody(scene, id);
    if (!place) return false;
    if (place->soft) {
        const Rod& rod = scene.soft[place->index].model.rod;
        return rod.needle && !isCut(rod, 0); // a tip of one node has no direction
    }
    const auto& needle = scene.rigid[place->index].model.needle;
    return needle && point.of == BodyPoint::Of::Rigid && plan[point.body].element == needle->element;
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
        const auto entry = embedNearest(meanOf(touched, x), touched, tissue.model, x);
        if (!entry) continue;
        Channel channel{.tissue = push.tissue,
                        .spacing = spacingOf(scene, push.needle),
                        .lines = {{push.needle}},
                        .points = {},
                        .end = *entry};
        channel.points.push_back({.nodes = *entry, .held = needle.nearest(meanOf(*entry, x), 0.0)});
        scene.channels.push_back(std::move(channel));
    }
}

} // namespace filasofia::engine
