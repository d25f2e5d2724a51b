#include "filasofia/engine/step/reset_scene.h"

#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/contact/warm_start.h"
#include "filasofia/engine/rigid/articulation_step.h"
#include "filasofia/engine/topology/loose_pieces.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

/// The points at which a body that is whole again is held (side 0) or holds (side 1): those from before the first edit
/// are where they were. Attachments made since then that held nodes which no longer exist are released.
void restoreAttachments(const BodyTopology& topology, const SoftModel& whole, std::size_t side, Scene& scene)
{
    const auto lost = [&](const NodeWeight& each) { return static_cast<std::size_t>(each.node) >= whole.rest.size(); };
    for (std::size_t a = scene.attachments.size(); a-- > 0;) {
        Attachment& each = scene.attachments[a];
        if ((side == 0 ? each.body : each.to) != whole.id) continue;
        const auto before = std::ranges::find(topology.startAttachments, each.id, &Attachment::id);
        bool gone = false;
        for (std::size_t p = 0; p < each.pairs.size(); ++p) {
            if (before != topology.startAttachments.end()) each.pairs[p][side] = before->pairs[p][side];
            gone = gone || std::ranges::any_of(each.pairs[p][side].nodes, lost);
        }
        if (gone) release(each.id, scene);
    }
}

/// Makes a body that was cut or torn what it was before. Attachments made meanwhile go with the nodes that they held.
void makeWhole(SoftBody& body, Scene& scene)
{
    BodyTopology& topology = body.topology;
    topology.strokes.clear();
    topology.followed = false; // it is put back: no way that tissue went
    if (topology.revision == 0) return;
    SoftModel whole = std::move(*topology.start);
    whole.id = body.model.id;
    const std::size_t nodes = whole.rest.size();
    for (std::size_t m = 0; m < whole.collision.size(); ++m) forgetSurface({whole.id, static_cast<int>(m)}, scene);
    for (std::size_t side : {0, 1}) restoreAttachments(topology, whole, side, scene);
    body.model = std::move(whole);
    body.state.forces.resize(nodes);
    topology = makeTopology(body.model);
    body.model.pieces = findPieces(body.model, *topology.pieces);
    outdate(true, body.system);
}

} // namespace

void resetScene(Scene& scene)
{
    for (SoftBody& body : scene.soft) makeWhole(body, scene);
    for (SoftBody& body : scene.soft) {
        SoftState fresh = stateAtRest(body.model);
        fresh.forces = std::move(body.state.forces);
        fresh.pressure = body.state.pressure;
        body.state = std::move(fresh);
    }
    for (std::size_t b = 0; b < scene.rigid.size(); ++b) {
        RigidBody& body = scene.rigid[b];
        RigidState fresh = stateAtStart(body.model);
        fresh.wrenches = std::move(body.state.wrenches);
        fresh.hands = std::move(body.state.hands);
        body.state = std::move(fresh);
        placeLinks(b, scene); // bodies that take others along come before them
    }
    scene.contacts.clear();
    scene.touching.clear();
    scene.sides.clear(); // who was on which side of a sheet is no longer so
    for (std::vector<Vec3>& forces : scene.holding) std::ranges::fill(forces, Vec3{});
    scene.held.clear();
}

} // namespace filasofia::engine
