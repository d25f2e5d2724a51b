#include "filasofia/engine/topology/remove_piece.h"

#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/topology/follow_surface.h"

#include <algorithm>

namespace filasofia::engine {
bool removePiece(int piece, SoftBody& body, Scene& scene)
{
    SoftModel& model = body.model;
    SoftState& state = body.state;
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
        for (int node : mesh.tetrahedra[e]) gone[static_cast<std::size_t>(node)] = true;
    }
    if (elements.empty() || left == 0) return false;

    model.removed.insert(piece);
    std::erase_if(model.pieces, [&](const BodyPiece& each) { return each.number == piece; });
    for (std::size_t i = 0; i < gone.size(); ++i) {
        if (!gone[i]) continue;
        model.pins.hard[i] = true;
        state.v[i] = state.dv[i] = state.residual[i] = state.forces[i] = {};
    }
    topology.mesh->remove(elements);
    const auto isGone = [&](int node) { return static_cast<bool>(gone[static_cast<std::size_t>(node)]); };
    for (PinGroup& group : model.pins.groups) std::erase_if(group.nodes, isGone);
    std::erase_if(model.pins.springs, [&](const PinSpring& pin) { return isGone(pin.node); });
    editOwnCollision(takeOffSurface(goes, topology, model), model, scene);
    const auto lost = [&](const NodeWeight& each) { return gone[static_cast<std::size_t>(each.node)]; };
    for (std::size_t a = scene.attachments.size(); a-- > 0;) {
        const Attachment& each = scene.attachments[a];
        const bool held = std::ranges::any_of(each.pairs, [&](const auto& pair) {
            return (each.body == model.id && std::ranges::any_of(pair[0].nodes, lost)) ||
                   (each.to == model.id && std::ranges::any_of(pair[1].nodes, lost));
        });
        if (held) release(each.id, scene);
    }
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
