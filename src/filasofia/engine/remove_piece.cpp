#include "filasofia/engine/remove_piece.h"

#include "filasofia/engine/attachments.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

/// Takes the triangles of these elements off the surface.
OwnSurfaceEdit takeOff(const std::vector<char>& goes, BodyTopology& topology, SoftModel& model)
{
    OwnSurfaceEdit edit;
    auto boundary = std::make_shared<frame::Boundary>(*topology.boundary);
    std::vector<geometry::Triangle> surface;
    std::vector<std::array<int, 2>> faces;
    boundary->opened.clear();
    for (std::size_t t = 0; t < model.surface.size(); ++t) {
        const auto [element, face] = topology.boundaryFaces[t];
        int& place = topology.boundaryPlaces[static_cast<std::size_t>(element)][static_cast<std::size_t>(face)];
        if (goes[static_cast<std::size_t>(element)] != 0) {
            edit.surface.removed.push_back(static_cast<int>(t));
            place = -1;
            continue;
        }
        place = static_cast<int>(surface.size());
        surface.push_back(model.surface[t]);
        faces.push_back(topology.boundaryFaces[t]);
        boundary->opened.push_back(topology.boundary->opened[t]);
    }
    model.surface = std::move(surface);
    topology.boundaryFaces = std::move(faces);
    boundary->triangles = model.surface;
    ++boundary->revision;
    topology.boundary = std::move(boundary);
    return edit;
}

} // namespace

bool removePiece(int piece, BodyTopology& topology, SoftModel& model, SoftState& body, State& state)
{
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
    for (std::size_t i = 0; i < gone.size(); ++i) {
        if (!gone[i]) continue;
        model.pins.hard[i] = true;
        body.v[i] = body.dv[i] = body.leftover[i] = body.forces[i] = {};
    }
    topology.mesh->remove(elements);
    const auto isGone = [&](int node) { return static_cast<bool>(gone[static_cast<std::size_t>(node)]); };
    for (PinGroup& group : model.pins.groups) std::erase_if(group.nodes, isGone);
    std::erase_if(model.pins.springs, [&](const PinSpring& pin) { return isGone(pin.node); });
    const OwnSurfaceEdit edit = takeOff(goes, topology, model);
    for (int m = 0; m < static_cast<int>(model.collision.size()); ++m)
        if (!model.collision[static_cast<std::size_t>(m)].behind.empty()) editCollision(edit, m, model, state);
    const auto lost = [&](const NodeWeight& each) { return gone[static_cast<std::size_t>(each.node)]; };
    for (std::size_t a = state.attachments.size(); a-- > 0;) {
        const Attachment& each = state.attachments[a];
        const bool held = std::ranges::any_of(each.pairs, [&](const auto& pair) {
            return (each.body == model.id && std::ranges::any_of(pair[0].nodes, lost)) ||
                   (each.to == model.id && std::ranges::any_of(pair[1].nodes, lost));
        });
        if (held) release(each.id, state);
    }
    return true;
}

} // namespace filasofia::engine
