#include "filasofia/engine/topology/remove_piece.h"

#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/contact/clip_holds.h"
#include "filasofia/engine/rupture/tet_shape.h"
#include "filasofia/engine/topology/cut_rods.h"
#include "filasofia/engine/topology/follow_surface.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

/// Lets go of nodes that are gone for good: they are pinned where they are, and nothing holds them.
void forget(const std::vector<bool>& gone, SoftBody& body, Scene& scene, physics::StepReport& report)
{
    SoftModel& model = body.model;
    SoftState& state = body.state;
    for (std::size_t i = 0; i < gone.size(); ++i) {
        if (!gone[i]) continue;
        model.pins.hard[i] = true;
        state.v[i] = state.dv[i] = state.residual[i] = state.forces[i] = {};
    }
    const auto isGone = [&](int node) { return static_cast<bool>(gone[static_cast<std::size_t>(node)]); };
    for (PinGroup& group : model.pins.groups) std::erase_if(group.nodes, isGone);
    std::erase_if(model.pins.springs, [&](const PinSpring& pin) { return isGone(pin.node); });
    forgetClipNodes(gone, body, scene, report);
    const auto lost = [&](const NodeWeight& each) { return gone[static_cast<std::size_t>(each.node)]; };
    for (std::size_t a = scene.attachments.size(); a-- > 0;) {
        const Attachment& each = scene.attachments[a];
        const bool held = std::ranges::any_of(each.pairs, [&](const auto& pair) {
            return (each.body == model.id && std::ranges::any_of(pair[0].nodes, lost)) ||
                   (each.to == model.id && std::ranges::any_of(pair[1].nodes, lost));
        });
        if (held) release(each.id, scene);
    }
}

/// Takes a piece off a rod: all edges of its nodes are cut, and no line of a channel runs through it.
bool removeRodPiece(int piece, SoftBody& body, Scene& scene, physics::StepReport& report)
{
    SoftModel& model = body.model;
    Rod& rod = model.rod;
    const auto found = std::ranges::find(model.pieces, piece, &BodyPiece::number);
    if (found == model.pieces.end() || model.pieces.size() < 2) return false;
    std::vector<bool> gone(model.rest.size());
    for (int node : found->nodes) gone[static_cast<std::size_t>(node)] = true;
    model.removed.insert(piece);
    model.pieces.erase(found);
    for (std::size_t e = 0; e < rod.edges.size(); ++e) {
        if (!gone[e] && !gone[static_cast<std::size_t>(rod.edges[e].nodes[1])]) continue;
        rod.cut[e] = true;
        body.state.rod.tensions[e] = body.state.rod.spins[e] = 0.0;
    }
    forget(gone, body, scene, report);
    for (Channel& each : scene.channels) {
        const std::size_t lines = each.lines.size();
        const bool cuts = each.lines.front().body == model.id;
        std::erase_if(each.lines, [&](const ThreadedLine& line) {
            return line.body == model.id && gone[line.reversed ? gone.size() - 1 - line.first : line.first];
        });
        each.through = each.through || (cuts && each.lines.size() < lines);
    }
    std::erase_if(scene.channels, [](const Channel& each) { return each.lines.empty(); });
    cutRodCollision(model, scene);
    return true;
}

} // namespace

bool removePiece(int piece, SoftBody& body, Scene& scene, physics::StepReport& report)
{
    if (isRod(body.model)) return removeRodPiece(piece, body, scene, report);
    SoftModel& model = body.model;
    BodyTopology& topology = body.topology;
    if (!topology.mesh) return false;
    const std::vector<int>& pieces = topology.pieces->ofTetrahedron();
    const MeshTopology& mesh = topology.mesh->data();
    std::vector<char> goes(pieces.size());
    std::vector<bool> gone(model.rest.size());
    std::vector<int> elements;
    std::size_t left = 0;
    for (std::size_t e = 0; e < pieces.size(); ++e) {
        const bool there = !model.removed.contains(pieces[e]);
        if (there && pieces[e] != piece) ++left;
        if (!there || pieces[e] != piece) continue;
        goes[e] = 1;
        elements.push_back(static_cast<int>(e));
        for (int node : nodesOf(mesh.tetrahedra[e])) gone[static_cast<std::size_t>(node)] = true;
    }
    if (elements.empty() || left == 0) return false;

    model.removed.insert(piece);
    std::erase_if(model.pieces, [&](const BodyPiece& each) { return each.number == piece; });
    topology.mesh->remove(elements);
    forget(gone, body, scene, report);
    editOwnCollision(takeOffSurface(goes, topology, model), model, scene);
    followCavities(topology, model);
    const auto lost = [&](const NodeWeight& each) { return gone[static_cast<std::size_t>(each.node)]; };
    for (Channel& each : scene.channels) {
        if (each.tissue != model.id) continue;
        std::erase_if(each.points, [&](const ChannelPoint& point) { return std::ranges::any_of(point.nodes, lost); });
        if (each.points.empty() || !std::ranges::any_of(each.end, lost)) continue;
        each.end = each.points.back().nodes;
        each.through = true; // the tip has nothing to cut any more
    }
    std::erase_if(scene.channels, [](const Channel& each) { return each.points.empty(); });
    return true;
}

} // namespace filasofia::engine
