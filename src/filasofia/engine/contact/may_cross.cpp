#include "filasofia/engine/contact/may_cross.h"

#include "filasofia/engine/scene/find_body.h"
#include "filasofia/engine/scene/line_radius.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

bool isBetween(const Attachment& attachment, BodyId a, BodyId b)
{
    return (attachment.body == a && attachment.to == b) || (attachment.body == b && attachment.to == a);
}

/// Whether an attachment between two bodies holds a place on the surface of one of them. A rigid body is held as a
/// whole.
bool holds(const Attachment& attachment, const SurfacePlace& place)
{
    const SurfaceOwner& owner = place.owner;
    if (!owner.soft) return true;
    const std::size_t side = attachment.body == owner.name.body ? 0 : 1;
    const auto isHeld = [&](int node) {
        return std::ranges::any_of(attachment.pairs, [&](const std::array<AttachedPoint, 2>& pair) {
            return std::ranges::find(pair[side].nodes, node, &NodeWeight::node) != pair[side].nodes.end();
        });
    };
    const geometry::Embedding& embedding = owner.collision->embedding;
    return std::ranges::any_of(place.vertices, [&](int vertex) {
        if (vertex < 0) return false;
        const auto at = static_cast<std::size_t>(vertex);
        for (std::size_t k = 0; k < 4; ++k)
            if (embedding.weights[at][k] != 0.0 && isHeld(embedding.nodes[at][k])) return true;
        return false;
    });
}

} // namespace

bool holdsTogether(const Scene& scene, const SurfacePlace& one, const SurfacePlace& two)
{
    return isHeldBy(scene, one, two.owner.name.body) || isHeldBy(scene, two, one.owner.name.body);
}

bool isHeldBy(const Scene& scene, const SurfacePlace& place, BodyId other)
{
    return std::ranges::any_of(scene.attachments, [&](const Attachment& each) {
        return isBetween(each, place.owner.name.body, other) && holds(each, place);
    });
}

bool areAttached(const Scene& scene, BodyId a, BodyId b)
{
    return std::ranges::any_of(scene.attachments, [&](const Attachment& each) { return isBetween(each, a, b); });
}

void eraseHeld(const Scene& scene, const SurfaceOwner& one, const SurfaceOwner& two, std::array<int, 2> places,
               std::vector<SurfaceCrossing>& crossings)
{
    const auto ownerOf = [&](int place) -> const SurfaceOwner& { return place == places[0] ? one : two; };
    std::erase_if(crossings, [&](const SurfaceCrossing& crossing) {
        return holdsTogether(scene, {ownerOf(crossing.surfaces[0]), crossing.edge},
                             {ownerOf(crossing.surfaces[1]), crossing.triangle});
    });
}

std::vector<WideChannel> channelsBetween(const Scene& scene, BodyId a, BodyId b)
{
    std::vector<WideChannel> between;
    for (const Channel& each : scene.channels) {
        const auto runs = [&](BodyId id) {
            return std::ranges::find(each.lines, id, &ThreadedLine::body) != each.lines.end();
        };
        if (!(each.tissue == a && runs(b)) && !(each.tissue == b && runs(a))) continue;
        WideChannel& wide = between.emplace_back(WideChannel{.channel = &each});
        for (const ThreadedLine& line : each.lines) wide.radius = std::max(wide.radius, lineRadius(scene, line.body));
    }
    return between;
}

bool isIn(const WideChannel& wide, Vec3 place, double proximities, const Scene& scene)
{
    const Channel& channel = *wide.channel;
    const std::vector<Vec3>& x = scene.soft[findBody(scene, channel.tissue)->index].state.x;
    return distanceToPath(channel, place, x) < 2.0 * (wide.radius + proximities) + channel.spacing;
}

bool isClipped(const Scene& scene, const SurfaceOwner& owner, Vec3 place)
{
    if (!owner.soft) return false;
    return std::ranges::any_of(scene.soft[owner.body].state.clips, [&](const Clip& clip) {
        const auto rigid = findIn(scene.rigid, clip.clip);
        if (!rigid) return false;
        const Pose& pose = scene.rigid[*rigid].state.poses[static_cast<std::size_t>(clip.def.element)];
        const Vec3 at = transform(inverse(pose), place);
        const double half = 0.5 * clip.def.opening;
        return std::abs(at.x) < 0.5 * clip.def.width + half && std::abs(at.y) < half &&
               std::abs(at.z) < 0.5 * clip.def.length + half;
    });
}

} // namespace filasofia::engine
