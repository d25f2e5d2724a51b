#include "filasofia/sofa/follow_cut.h"

#include "filasofia/engine/rupture/keep_momentum.h"
#include "filasofia/engine/rupture/pin_new_nodes.h"
#include "filasofia/geometry/adjacency.h"

#include <algorithm>

namespace filasofia::sofaengine {
namespace {

using frame::TopologyEdit;

/// The points of attachments on the body, as points in its tetrahedra before an edit.
class TiedPoints {
public:
    TiedPoints(const TopologyEdit& edit, const SoftPlan& before) : before_(before.mesh)
    {
        reached_.resize(before_.nodes.size());
        for (const frame::TetNodes& changed : edit.changed)
            if (at(changed.tetrahedron) < before_.tetrahedra.size())
                for (const int node : before_.tetrahedra[at(changed.tetrahedron)]) reached_[at(node)] = 1;
    }

    /// A point that no element has keeps its nodes.
    void add(TiePoint& point)
    {
        std::vector<int> nodes;
        for (std::size_t k = 0; k < 4; ++k)
            if (point.weights[k] != 0.0) nodes.push_back(point.nodes[k]);
        if (std::ranges::none_of(nodes, [&](int node) { return reached_[at(node)] != 0; })) return;
        frame::EmbeddedPoint embedded{.tetrahedron = elementWith(nodes)};
        if (embedded.tetrahedron < 0) return;
        const geometry::Tetrahedron& corners = before_.tetrahedra[at(embedded.tetrahedron)];
        for (std::size_t k = 0; k < 4; ++k)
            for (std::size_t c = 0; c < 4; ++c)
                if (point.weights[k] != 0.0 && corners[c] == point.nodes[k]) embedded.weights[c] += point.weights[k];
        points_.push_back(embedded);
        tied_.push_back(&point);
    }

    void follow(const TopologyEdit& edit, const std::vector<geometry::Tetrahedron>& now)
    {
        std::vector<geometry::Tetrahedron> tetrahedra = before_.tetrahedra;
        std::vector<Vec3> rest = before_.nodes;
        frame::followPoints(edit, tetrahedra, rest, points_);
        for (std::size_t i = 0; i < points_.size(); ++i)
            *tied_[i] = {now[at(points_[i].tetrahedron)], points_[i].weights};
    }

private:
    /// The first element that has all of these nodes; -1 if there is none.
    int elementWith(const std::vector<int>& nodes)
    {
        if (around_.start.empty()) around_ = geometry::tetrahedraAroundNodes(before_);
        for (const int t : around_[nodes.front()])
            if (std::ranges::all_of(nodes,
                                    [&](int node) { return std::ranges::count(before_.tetrahedra[at(t)], node) > 0; }))
                return t;
        return -1;
    }

    const geometry::TetMesh& before_;
    geometry::CompressedRows around_ = {};
    std::vector<char> reached_;
    std::vector<frame::EmbeddedPoint> points_ = {};
    std::vector<TiePoint*> tied_ = {};
};

void followTies(const TopologyEdit& edit, const std::vector<geometry::Tetrahedron>& now, BodyId id, BodyDraft& body)
{
    TiedPoints points(edit, body.plan);
    for (TieState& tie : body.ties)
        for (TieRows::Pair& pair : tie.pairs) {
            if (tie.body.id == id) points.add(pair.first);
            if (tie.to.id == id) points.add(pair.second);
        }
    points.follow(edit, now);
}

/// A new node between two pinned nodes is pinned, and a copy of one. Spring pins stay with the original node and slide
/// with it.
void followPins(const TopologyEdit& edit, const std::vector<Vec3>& places, std::vector<PinGroup>& pins)
{
    const auto isHeld = [&](int node) {
        return std::ranges::any_of(pins, [&](const PinGroup& each) { return engine::holdsHard(each, node); });
    };
    const auto pin = [&](int node, int a, int b) {
        if (!isHeld(a) || !isHeld(b)) return;
        engine::pinBetween(a, b, pins, [&](PinGroup& group) {
            group.nodes.push_back(node);
            group.places.push_back(places[at(node)]);
        });
    };
    for (const frame::TopologyOp& op : edit.ops)
        if (const auto* made = std::get_if<frame::NewNode>(&op)) {
            pin(made->node, made->a, made->b);
        } else if (const auto* copy = std::get_if<frame::NodeCopy>(&op)) {
            pin(copy->copy, copy->from, copy->from);
        } else if (const auto* moved = std::get_if<frame::NodeMove>(&op)) {
            for (PinGroup& group : pins)
                for (std::size_t i = 0; i < group.nodes.size(); ++i)
                    if (group.nodes[i] == moved->node && group.stiffness != physics::kHard)
                        group.places[i] += moved->newRest - moved->oldRest;
        }
}

/// Nodes whose mass an edit has changed keep their momentum; what is held rests.
void keepMomentum(const SoftPlan& old, const std::vector<Vec3>& velocities, BodyDraft& body)
{
    const std::vector<std::uint8_t> held = heldNodes(body.settings.pins, body.state.velocities.size());
    std::vector<int> reached;
    for (std::size_t i = 0; i < held.size(); ++i) {
        if ((i < old.masses.size() ? old.masses[i] : 0.0) == body.plan.masses[i]) continue;
        if (held[i] != 0) body.state.velocities[i] = {};
        reached.push_back(static_cast<int>(i));
    }
    engine::keepMomentum(
        engine::momentumOf(reached, old.masses, velocities), reached, body.plan.masses,
        [&](int node) { return held[at(node)] != 0; }, body.state.velocities);
}

} // namespace

void followCut(const TopologyEdit& edit, SoftCuts& cuts, BodyDraft& body)
{
    const engine::MeshTopology& mesh = cuts.mesh.data();
    const SoftPlan old = body.plan;
    const std::vector<Vec3> velocities = body.state.velocities;
    followTies(edit, mesh.tetrahedra, edit.body, body);
    followPins(edit, mesh.current, body.settings.pins);
    frame::followNodes(edit, body.state.velocities);
    body.state.positions = mesh.current;
    body.plan.mesh = {mesh.rest, mesh.tetrahedra};
    frame::followElements(edit, cuts.origin);
    if (!body.plan.gone.empty()) frame::followElements(edit, body.plan.gone);
    inheritTissue(cuts, body.plan);
    shapePlan(body.plan);
    keepMomentum(old, velocities, body);
    cuts.history = engine::historyWith(edit, cuts.history);
    if (!edit.boundary.empty()) publishBoundary(cuts);
}

void makeWhole(const SoftCuts& cuts, BodyDraft& body)
{
    body.plan = cuts.start;
    const auto count = static_cast<int>(body.plan.mesh.nodes.size());
    body.state = {body.plan.mesh.nodes, std::vector<Vec3>(at(count))};
    for (PinGroup& group : body.settings.pins)
        if (const auto first = std::ranges::find(body.plan.pins, group.id, &PinGroup::id);
            first != body.plan.pins.end())
            group = *first; // where slides began, with the nodes of pieces that were removed
    eraseNodes([&](int node) { return node >= count; }, body.settings.pins);
    std::erase_if(body.settings.pins, [](const PinGroup& each) { return each.nodes.empty(); });
}

void forgetGone(BodyDraft& body)
{
    const std::vector<char> gone = goneNodes(body.plan);
    for (std::size_t i = 0; i < gone.size(); ++i)
        if (gone[i] != 0) body.state.velocities[i] = {};
    const auto isGone = [&](int node) { return gone[at(node)] != 0; };
    std::erase_if(body.settings.pins, [&](const PinGroup& each) {
        const bool ofDef = std::ranges::find(body.plan.pins, each.id, &PinGroup::id) != body.plan.pins.end();
        return !ofDef && std::ranges::any_of(each.nodes, isGone);
    });
    eraseNodes(isGone, body.settings.pins);
}

std::vector<physics::LoosePiece> loosePieces(const TopologyEdit& edit, SoftCuts& cuts, const BodyDraft& body)
{
    std::vector<char> held(body.plan.mesh.nodes.size());
    for (const PinGroup& group : body.settings.pins)
        for (const int node : group.nodes) held[at(node)] = 1;
    std::vector<physics::LoosePiece> loose;
    for (engine::DetachedPiece& piece : cuts.pieces.update(cuts.mesh.data(), edit)) {
        physics::LoosePiece& out = loose.emplace_back(physics::LoosePiece{.piece = piece.id});
        Vec3 moment;
        for (const int t : piece.tetrahedra)
            for (const int node : body.plan.mesh.tetrahedra[at(t)]) {
                const double mass = body.plan.density[at(t)] * signedVolume(body.plan.mesh, t) / 4.0;
                out.mass += mass;
                moment += mass * body.state.positions[at(node)];
                out.held = out.held || held[at(node)] != 0;
            }
        out.place = 1.0 / out.mass * moment;
        out.elements = std::move(piece.tetrahedra);
    }
    return loose;
}

} // namespace filasofia::sofaengine
