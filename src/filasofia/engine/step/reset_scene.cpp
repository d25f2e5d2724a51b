#include "filasofia/engine/step/reset_scene.h"

#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/contact/warm_start.h"
#include "filasofia/engine/rigid/articulation_step.h"
#include "filasofia/engine/topology/loose_pieces.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

/// Restores the attachment points on a body that is whole again: `side` 0 if it is the attached body, 1 if others are
/// attached to it. Attachments from before the first edit get their old points. Later attachments are released if one
/// of their nodes no longer exists.
void restoreAttachments(const BodyTopology& topology, const SoftModel& whole, std::size_t side, Scene& scene)
{
    const auto lost = [&](const NodeWeight& each) { return static_cast<std::size_t>(each.node) >= whole.rest.size(); };
    for (std::size_t a = scene.attachments.size(); a-- > 0;) {
        Attachment& each = scene.attachments[a];
        if ((side == 0 ? each.body : each.to) != whole.id) continue;
        const auto before = std::ranges::find(topology.startAttachments, each.id, &Attachment::id);
        bool gone = false;
        for (std::size_t p = 0; p < each.pairs.size(); ++p) {
            if (before != topology.startAttachments.end() && !each.whole) each.pairs[p][side] = before->pairs[p][side];
            gone = gone || std::ranges::any_of(each.pairs[p][side].nodes, lost);
        }
        if (gone) release(each.id, scene);
    }
}

/// Restores the mesh of a body that was cut or torn. Attachments created since are released if a node of theirs no
/// longer exists.
void restoreMesh(SoftBody& body, Scene& scene)
{
    BodyTopology& topology = body.topology;
    topology.strokes.clear();
    topology.followed = false; // the jump to the start is not a motion that blades could cut along
    if (topology.revision == 0) return;
    SoftModel whole = std::move(*topology.start);
    whole.id = body.model.id;
    const std::size_t nodes = whole.rest.size();
    for (std::size_t m = 0; m < whole.collision.size(); ++m) forgetSurface({whole.id, static_cast<int>(m)}, scene);
    for (std::size_t side : {0, 1}) restoreAttachments(topology, whole, side, scene);
    body.model = std::move(whole);
    body.state.forces.resize(nodes);
    topology = makeTopology(body.model);
    if (topology.pieces) body.model.pieces = findPieces(body.model, *topology.pieces);
    outdate(true, body.system);
}

} // namespace

void resetScene(Scene& scene)
{
    for (SoftBody& body : scene.soft) // clips open
        for (const Clip& clip : body.state.clips) release(clip.id, scene);
    scene.clipReports.clear();
    for (std::size_t a = 0; a < scene.attachments.size(); ++a) {
        Attachment& each = scene.attachments[a];
        if (each.whole) each.pairs = *each.whole;
        scene.attachmentForces[a].resize(each.pairs.size() + each.turns.size());
    }
    for (SoftBody& body : scene.soft) {
        restoreMesh(body, scene);
        if (!body.model.patched) continue;
        healTissue(body.model);
        outdate(body.system.tuned, body.system);
    }
    for (SoftBody& body : scene.soft) {
        SoftState fresh = stateAtStart(body.model);
        fresh.forces = std::move(body.state.forces);
        fresh.pressure = body.state.pressure;
        for (std::size_t c = 0; c < fresh.cavities.size(); ++c) {
            fresh.cavities[c].inflow = body.state.cavities[c].inflow;
            fresh.cavities[c].pressure = body.state.cavities[c].pressure;
        }
        fresh.rod.steering = std::move(body.state.rod.steering);
        fresh.rod.steeringRate = body.state.rod.steeringRate;
        for (RodSteering& each : fresh.rod.steering) each.now = {};
        body.state = std::move(fresh);
    }
    for (std::size_t b = 0; b < scene.rigid.size(); ++b) {
        RigidBody& body = scene.rigid[b];
        RigidState fresh = stateAtStart(body.model);
        fresh.wrenches = std::move(body.state.wrenches);
        fresh.couplings = std::move(body.state.couplings);
        fresh.cutting = body.state.cutting;
        body.state = std::move(fresh);
        placeLinks(b, scene); // a carrier comes before the bodies that it carries
    }
    scene.contacts.clear();
    scene.contactReports.clear();
    scene.sides.clear(); // bodies have moved: the sides of sheets are unknown again
    for (std::vector<Vec3>& forces : scene.attachmentForces) std::ranges::fill(forces, Vec3{});
    scene.attachmentReports.clear();
    scene.ties = {}; // made anew in the next step, as in the first one
    scene.channels.clear();
    scene.channelReports.clear();
}

} // namespace filasofia::engine
