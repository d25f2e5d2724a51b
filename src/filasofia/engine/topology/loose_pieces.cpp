#include "filasofia/engine/topology/loose_pieces.h"

#include "filasofia/core/log.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/soft/rigid_motion.h"

#include <algorithm>

namespace filasofia::engine {

std::vector<BodyPiece> findPieces(const SoftModel& model, const Pieces& pieces)
{
    constexpr std::size_t kMaxFragment = 32; // elements
    if (pieces.count() < 2) return {};
    const std::vector<int>& pieceOf = pieces.ofTetrahedron();
    std::vector<BodyPiece> list(static_cast<std::size_t>(*std::ranges::max_element(pieceOf)) + 1);
    for (std::size_t p = 0; p < list.size(); ++p) list[p].number = static_cast<int>(p);
    std::vector<int> ofNode(model.rest.size(), -1);
    for (std::size_t e = 0; e < pieceOf.size(); ++e) {
        const geometry::Tetrahedron of = elementNodes(model, e);
        for (int node : nodesOf(of)) ofNode[static_cast<std::size_t>(node)] = pieceOf[e];
        std::vector<int>& elements = list[static_cast<std::size_t>(pieceOf[e])].elements;
        if (elements.size() <= kMaxFragment) elements.push_back(static_cast<int>(e));
    }
    for (std::size_t i = 0; i < ofNode.size(); ++i)
        if (ofNode[i] >= 0) list[static_cast<std::size_t>(ofNode[i])].nodes.push_back(static_cast<int>(i));
    for (BodyPiece& piece : list)
        if (piece.elements.size() > kMaxFragment) piece.elements = {};
    std::erase_if(list,
                  [&](const BodyPiece& each) { return each.nodes.empty() || model.removed.contains(each.number); });
    findHeld(model.pins, list);
    return list;
}

void measure(const SoftModel& model, const SoftState& state, std::vector<physics::LoosePiece>& loose)
{
    for (physics::LoosePiece& each : loose) {
        const auto found = std::ranges::find(model.pieces, each.piece, &BodyPiece::number);
        if (found == model.pieces.end()) continue;
        Vec3 moment;
        for (const int node : found->nodes) {
            const auto n = static_cast<std::size_t>(node);
            each.mass += model.masses[n];
            moment += model.masses[n] * state.x[n];
        }
        each.place = 1.0 / each.mass * moment;
        each.held = found->held;
    }
}

void findHeld(const Pins& pins, std::vector<BodyPiece>& pieces)
{
    if (pieces.empty()) return;
    std::vector<bool> held(pins.hard);
    for (const PinSpring& pin : pins.springs) held[static_cast<std::size_t>(pin.node)] = true;
    const auto isHeld = [&](int node) { return held[static_cast<std::size_t>(node)]; };
    for (BodyPiece& piece : pieces) piece.held = std::ranges::any_of(piece.nodes, isHeld);
}

void limitSpin(const SoftModel& model, double maxTurn, double dt, SoftState& state)
{
    for (const BodyPiece& piece : model.pieces) {
        if (piece.held) continue;
        const auto at = [&](int i) { return static_cast<std::size_t>(piece.nodes[static_cast<std::size_t>(i)]); };
        const RigidMotion motion = rigidMotionOf(
            static_cast<int>(piece.nodes.size()), [&](int i) { return model.masses[at(i)]; },
            [&](int i) { return state.x[at(i)]; }, [&](int i) { return model.masses[at(i)] * state.v[at(i)]; });
        const double turn = dt * length(motion.angular);
        if (!(turn > maxTurn) || !isFinite(motion.angular)) continue;
        const Vec3 excess = (1.0 - maxTurn / turn) * motion.angular;
        for (int node : piece.nodes) {
            const auto i = static_cast<std::size_t>(node);
            state.v[i] -= cross(excess, state.x[i] - motion.centre);
        }
    }
}

namespace {

constexpr double kPushed = 100.0; // [m/s]

bool isAttached(const BodyPiece& piece, BodyId body, const Scene& scene)
{
    const auto isOn = [&](const NodeWeight& at) { return std::ranges::binary_search(piece.nodes, at.node); };
    return std::ranges::any_of(scene.attachments, [&](const Attachment& each) {
        return std::ranges::any_of(each.pairs, [&](const auto& pair) {
            return (each.body == body && std::ranges::any_of(pair[0].nodes, isOn)) ||
                   (each.to == body && std::ranges::any_of(pair[1].nodes, isOn));
        });
    });
}

/// What acts on a piece.
struct Push {
    Vec3 force, momentum; ///< [N] from a user; [kg m/s]
    double mass = 0.0;    ///< [kg]
    /// [-] The part of the force that brings the piece to kPushed in a step.
    [[nodiscard]] double part(double dt) const
    {
        const double size = length(force);
        if (!(size > 0.0)) return 1.0;
        return std::clamp((kPushed * mass - dot(momentum, force) / size) / (dt * size), 0.0, 1.0);
    }
};

Push pushOn(const BodyPiece& piece, const SoftBody& body)
{
    Push push;
    for (const int node : piece.nodes) {
        const auto i = static_cast<std::size_t>(node);
        push.force += body.state.forces[i];
        push.momentum += body.model.masses[i] * body.state.v[i];
        push.mass += body.model.masses[i];
    }
    return push;
}

} // namespace

std::vector<ReducedForce> reducedForces(double dt, const SoftBody& body, const Scene& scene)
{
    std::vector<ReducedForce> reduced;
    if (!isRod(body.model)) return reduced;
    for (std::size_t p = 0; p < body.model.pieces.size(); ++p) {
        const BodyPiece& piece = body.model.pieces[p];
        if (piece.held) continue;
        const double part = pushOn(piece, body).part(dt);
        if (part < 1.0 && !isAttached(piece, body.model.id, scene)) reduced.push_back({p, part});
    }
    return reduced;
}

void tellForces(const std::vector<physics::LoosePiece>& loose, const SoftBody& body, const Scene& scene)
{
    if (loose.empty()) return;
    for (const BodyPiece& piece : body.model.pieces) {
        if (piece.held || isAttached(piece, body.model.id, scene)) continue;
        const Push push = pushOn(piece, body);
        if (!(length(push.force) > 0.0)) continue;
        logWarning("body '", body.model.name, "' has come apart, and forces of ", length(push.force),
                   " N still act on a loose piece of ", push.mass, " kg: they push it to ", kPushed,
                   " m/s at most; setForces() takes them away");
    }
}

std::vector<int> piecesBeyond(double far, const SoftModel& model, const SoftState& state)
{
    std::vector<PiecePlace> places;
    for (const BodyPiece& piece : model.pieces) {
        const auto first = static_cast<std::size_t>(piece.nodes.front());
        places.push_back({piece.number, piece.nodes.size(), state.x[first], model.rest[first]});
    }
    return piecesBeyond(far, places);
}

} // namespace filasofia::engine
