#include "filasofia/engine/contact/clip_holds.h"

#include "filasofia/core/log.h"
#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/scene/find_body.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

bool hasLost(const std::vector<bool>& gone, const std::vector<NodeWeight>& point)
{
    return std::ranges::any_of(point,
                               [&](const NodeWeight& each) { return gone[static_cast<std::size_t>(each.node)]; });
}

/// The mean of two points.
std::vector<NodeWeight> middleOfPair(const ClipPair& pair)
{
    std::vector<NodeWeight> out;
    for (const auto& side : pair)
        for (const NodeWeight& each : side) {
            const auto known = std::ranges::find(out, each.node, &NodeWeight::node);
            if (known == out.end())
                out.push_back({each.node, 0.5 * each.weight});
            else
                known->weight += 0.5 * each.weight;
        }
    return out;
}

/// Takes away the pairs that have lost a node. Those that the rigid body hangs on keep their order.
void erasePairsOf(const std::vector<bool>& gone, Clip& clip)
{
    std::vector<std::size_t> now(clip.pairs.size()); // the new index of each
    std::vector<bool> lost;
    for (std::size_t i = 0, left = 0; i < clip.pairs.size(); ++i) {
        lost.push_back(hasLost(gone, clip.pairs[i][0]) || hasLost(gone, clip.pairs[i][1]));
        now[i] = left;
        if (!lost.back()) ++left;
    }
    std::erase_if(clip.corners, [&](std::size_t i) { return lost[i]; });
    for (std::size_t& each : clip.corners) each = now[each];
    std::size_t i = 0;
    std::erase_if(clip.pairs, [&](const ClipPair&) { return static_cast<bool>(lost[i++]); });
}

/// Lets a clip hang where its nodes still are.
void forgetHold(const std::vector<bool>& gone, Clip& clip, const SoftState& tissue, Scene& scene)
{
    const auto found = std::ranges::lower_bound(scene.attachments, clip.id, {}, &Attachment::id);
    const auto at = static_cast<std::size_t>(found - scene.attachments.begin());
    std::vector<bool> lost;
    for (const auto& pair : found->pairs) lost.push_back(hasLost(gone, pair[1].nodes));
    erasePairs(at, lost, scene);
    if (!found->pairs.empty()) return;
    const RigidState& rigid = scene.rigid[*findIn(scene.rigid, clip.clip)].state;
    const Pose& pose = rigid.poses[static_cast<std::size_t>(clip.def.element)];
    found->pairs = holdPoints(pose, tissue, clip);
    scene.attachmentForces[at].resize(found->pairs.size());
}

} // namespace

AttachedPairs holdPoints(const Pose& pose, const SoftState& tissue, Clip& clip)
{
    const physics::ClipDef& def = clip.def;
    std::vector<std::vector<NodeWeight>> middles;
    std::vector<Vec3> places; // in the clip's coordinates
    for (const ClipPair& each : clip.pairs) {
        middles.push_back(middleOfPair(each));
        places.push_back(transform(inverse(pose), meanOf(middles.back(), tissue.x)));
    }
    std::vector<std::size_t>& chosen = clip.corners;
    chosen.clear();
    for (const auto& [x, z] : {std::pair{-1, -1}, std::pair{-1, 1}, std::pair{1, -1}, std::pair{1, 1}}) {
        const auto outwards = [&def, x = x, z = z](Vec3 place) {
            return x * place.x / def.width + z * place.z / def.length;
        };
        const auto corner = static_cast<std::size_t>(std::ranges::max_element(places, {}, outwards) - places.begin());
        if (std::ranges::find(chosen, corner) == chosen.end()) chosen.push_back(corner);
    }
    AttachedPairs points;
    for (std::size_t i : chosen)
        points.push_back({AttachedPoint{.nodes = {}, .element = def.element, .place = places[i]},
                          AttachedPoint{.nodes = std::move(middles[i]), .element = 0, .place = {}}});
    return points;
}

void followHolds(std::span<const Clip> clips, std::vector<Attachment>& attachments)
{
    for (const Clip& clip : clips) {
        const auto hold = std::ranges::lower_bound(attachments, clip.id, {}, &Attachment::id);
        if (hold == attachments.end() || hold->id != clip.id || hold->pairs.size() != clip.corners.size()) continue;
        for (std::size_t i = 0; i < clip.corners.size(); ++i)
            hold->pairs[i][1].nodes = middleOfPair(clip.pairs[clip.corners[i]]);
    }
}

void forgetClipNodes(const std::vector<bool>& gone, SoftBody& body, Scene& scene, physics::StepReport& report)
{
    std::vector<Clip>& clips = body.state.clips;
    for (Clip& each : clips) {
        erasePairsOf(gone, each);
        const bool hangs = std::ranges::binary_search(scene.attachments, each.id, {}, &Attachment::id);
        if (!hangs) continue; // it was released
        if (!each.pairs.empty()) {
            forgetHold(gone, each, body.state, scene);
            continue;
        }
        ++report.clips.slipped;
        report.clipChanges.push_back({.kind = physics::ClipChange::Kind::Slipped,
                                      .id = each.id,
                                      .clip = each.clip,
                                      .tissue = body.model.id,
                                      .partial = each.partial});
        logWarning(describe(body.model), ": the tissue in clip ", each.id.value, " was removed; the clip is gone");
        release(each.id, scene);
        std::erase_if(scene.clipReports, [&](const frame::Clip& clip) { return clip.id == each.id; });
    }
    std::erase_if(clips, [](const Clip& each) { return each.pairs.empty(); });
}

} // namespace filasofia::engine
