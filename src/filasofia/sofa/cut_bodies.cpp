#include "filasofia/sofa/cut_bodies.h"

#include "filasofia/core/log.h"
#include "filasofia/engine/rupture/elements_at.h"
#include "filasofia/geometry/box.h"
#include "filasofia/physics/limits.h"
#include "filasofia/sofa/moving_blades.h"
#include "filasofia/sofa/replace_body.h"
#include "filasofia/sofa/sofa_process.h"
#include "filasofia/sofa/tear_stress.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <optional>

namespace filasofia::sofaengine {
namespace {

using physics::Rupture;

/// A body while it is edited: what it will be, and what it goes back to if SOFA cannot make that.
struct Edited {
    BodyId id = {};
    SoftCuts before;
    BodyDraft draft;
};

/// One body's part of a stage.
struct Cutting {
    SoftNode& body;
    SofaScene& scene;
    physics::TopologyReport& report;
};

/// Brings the draft in line with what has been opened, and reports it. `before` of a first edit is made here.
void followEdits(Rupture::Kind kind, const Cutting& at, const SoftCuts& before, engine::RuptureReport& opened,
                 std::optional<Edited>& edited)
{
    SoftCuts& cuts = *at.body.cuts();
    if (!cuts.mesh.edited()) return;
    if (!edited) edited.emplace(Edited{at.body.id(), before, draftOf(at.body, at.scene)});
    BodyDraft& draft = edited->draft;
    const frame::TopologyEdit edit = cuts.mesh.takeEdit(at.body.id());
    const int nodes = edit.nodes - static_cast<int>(draft.plan.mesh.nodes.size());
    const int elements = edit.tetrahedra - static_cast<int>(draft.plan.mesh.tetrahedra.size());
    followCut(edit, cuts, draft);
    std::vector<physics::LoosePiece> loose = loosePieces(edit, cuts, draft);
    const std::size_t known = at.report.ruptures.size();
    moveRupture(kind, at.body.id(), opened, at.report);
    if (at.report.ruptures.size() == known) return;
    at.report.ruptures.back().nodes = nodes;
    at.report.ruptures.back().elements = elements;
    at.report.ruptures.back().detached = std::move(loose);
}

void cutBody(const Cutting& at, const std::vector<MovingBlade>& blades, std::optional<Edited>& edited)
{
    SoftCuts& cuts = *at.body.cuts();
    SoftState now;
    at.body.read(now);
    const std::vector<engine::Tool> tools = toolsNear(at.body, now.positions, blades, at.report);
    engine::beginStrokes(tools, cuts.mesh, cuts.strokes);
    const bool followed = std::exchange(cuts.followed, !cuts.strokes.empty());
    if (cuts.strokes.empty()) return;
    const SoftCuts before = cuts;
    if (followed)
        cuts.mesh.moveTo(now.positions);
    else
        cuts.mesh.placeAt(now.positions);
    engine::RuptureReport opened;
    for (const engine::RuptureReport& done : engine::cutWith(tools, cuts.mesh, cuts.strokes)) {
        opened += done;
        engine::add(done, at.report);
    }
    followEdits(Rupture::Kind::Cut, at, before, opened, edited);
}

void tearBody(const Cutting& at, std::optional<Edited>& edited)
{
    SoftCuts& cuts = *at.body.cuts();
    const SoftPlan& plan = edited ? edited->draft.plan : at.body.plan();
    if (plan.tearing.empty()) return;
    SoftState now;
    if (edited)
        now = edited->draft.state;
    else
        at.body.read(now);
    std::vector<std::uint8_t> held =
        heldNodes(edited ? edited->draft.settings.pins : at.body.pins(), now.positions.size());
    const std::vector<char> gone = goneNodes(plan);
    for (std::size_t i = 0; i < held.size(); ++i)
        if (gone[i] != 0) held[i] = 1;
    const std::vector<Mat3> stresses = tearingStresses(plan, now.positions, held);
    if (stresses.empty()) return;
    const SoftCuts before = cuts;
    if (!cuts.followed) cuts.mesh.placeAt(now.positions); // else cutBody() has moved it
    engine::RuptureReport opened = cuts.tearing.step(cuts.mesh, stresses, held, {.threshold = tearingThreshold(plan)});
    engine::add(opened, at.report);
    followEdits(Rupture::Kind::Tear, at, before, opened, edited);
}

/// Makes the body anew. If SOFA cannot, it stays as it was, and its strokes end.
void finish(Edited& edited, SofaScene& scene, physics::StepReport& report)
{
    SoftNode& body = *findBody(scene.soft, edited.id);
    const std::string name = body.plan().def.name;
    auto cuts = std::make_unique<SoftCuts>(std::move(*body.cuts()));
    const bool made = attempt(text("soft body '", name, "': the cut is undone, because SOFA failed"),
                              [&] { replaceBody(std::move(edited.draft), std::move(cuts), scene, edited.id); });
    if (made) return;
    edited.before.strokes.clear();
    edited.before.followed = false;
    *body.cuts() = std::move(edited.before);
    std::erase_if(report.topology.ruptures, [&](const Rupture& each) { return each.body == edited.id; });
    report.setUndone(edited.id);
}

void cutTies(const std::vector<MovingBlade>& blades, SofaScene& scene)
{
    const auto mayCut = [&](const MovingBlade& blade, BodyId id) {
        const SoftNode* body = findBody(scene.soft, id);
        return body && mayBeCut(body->plan().def, blade.group);
    };
    for (const auto& tie : scene.ties) {
        const double within = tie->law().cutDistance;
        if (within == 0.0) continue;
        tie->cut([&](Vec3 place) {
            return std::ranges::any_of(blades, [&](const MovingBlade& blade) {
                return !blade.jumped && (mayCut(blade, tie->body()) || mayCut(blade, tie->to())) &&
                       overlap(geometry::grown(blade.swept, within), {place, place}) &&
                       engine::distanceTo(blade.path(), place) <= within;
            });
        });
    }
}

bool takesNodes(const TieState& tie, BodyId id, const std::vector<char>& gone)
{
    return std::ranges::any_of(tie.pairs, [&](const TieRows::Pair& pair) {
        return (tie.body.id == id && dependsOn(pair.first, gone)) || (tie.to.id == id && dependsOn(pair.second, gone));
    });
}

/// [kg] per node that elements which are left have.
double heldMass(const SoftPlan& plan)
{
    const std::vector<char> gone = goneNodes(plan);
    double mass = 0.0;
    for (std::size_t node = 0; node < gone.size(); ++node)
        if (gone[node] == 0) mass += plan.masses[node];
    return mass;
}

} // namespace

void ruptureBodies(const SceneMotion& before, double dt, SofaScene& scene, physics::StepReport& report)
{
    const std::vector<MovingBlade> blades = moveBlades(before, dt, scene);
    std::vector<std::optional<Edited>> edited(scene.soft.size());
    for (std::size_t b = 0; b < scene.soft.size(); ++b)
        if (scene.soft[b]->cuts()) cutBody({*scene.soft[b], scene, report.topology}, blades, edited[b]);
    for (std::size_t b = 0; b < scene.soft.size(); ++b)
        if (scene.soft[b]->cuts()) tearBody({*scene.soft[b], scene, report.topology}, edited[b]);
    for (std::optional<Edited>& each : edited)
        if (each) finish(*each, scene, report);
    cutTies(blades, scene);
}

Removal removePieceOf(BodyId id, int piece, SofaScene& scene)
{
    const SoftNode& body = *findBody(scene.soft, id);
    auto cuts = std::make_unique<SoftCuts>(*body.cuts());
    BodyDraft draft = draftOf(body, scene);
    if (!removePiece(piece, *cuts, draft.plan)) return Removal::NoPiece;
    forgetGone(draft);
    const std::vector<char> gone = goneNodes(draft.plan);
    std::erase_if(draft.ties, [&](const TieState& each) { return takesNodes(each, id, gone); });
    const bool made = attempt(text("soft body '", body.plan().def.name, "': the piece stays, because SOFA failed"),
                              [&] { replaceBody(std::move(draft), std::move(cuts), scene, id); });
    return made ? Removal::Done : Removal::Failed;
}

void removeLostPieces(SofaScene& scene, physics::StepReport& report)
{
    for (std::size_t b = 0; b < scene.soft.size(); ++b) {
        if (!scene.soft[b]->cuts() || scene.soft[b]->cuts()->revision == 0) continue;
        SoftState now;
        scene.soft[b]->read(now);
        for (const int piece : piecesBeyond(physics::kLostDistance, *scene.soft[b]->cuts(), now.positions)) {
            const double before = heldMass(scene.soft[b]->plan());
            if (removePieceOf(scene.soft[b]->id(), piece, scene) != Removal::Done) continue;
            const std::vector<double>& masses = scene.soft[b]->plan().masses;
            const double mass = before - heldMass(scene.soft[b]->plan());
            const double whole = std::accumulate(masses.begin(), masses.end(), 0.0);
            ++report.topology.lost;
            report.topology.lostPieces.push_back({scene.soft[b]->id(), piece, mass, mass / whole});
        }
    }
}

engine::ElementsAtBlade elementsAtBlades(const RigidNode& tool, const SofaScene& scene)
{
    RigidState at;
    tool.read(at);
    engine::ElementsAtBlade count;
    for (const CollisionPlan& blade : tool.plan().collision) {
        if (!blade.def.cutting) continue;
        std::vector<Vec3> corners;
        for (const geometry::Triangle& triangle : blade.mesh.triangles)
            for (const int vertex : triangle)
                corners.push_back(transform(at.poses[static_cast<std::size_t>(blade.def.element)],
                                            blade.mesh.vertices[static_cast<std::size_t>(vertex)]));
        for (const auto& body : scene.soft) {
            if (!mayBeCut(body->plan().def, blade.def.group)) continue;
            SoftState now;
            body->read(now);
            const auto& tetrahedra = body->plan().mesh.tetrahedra;
            count += engine::elementsAt(corners,
                                        {.count = tetrahedra.size(),
                                         .nodes = [&](std::size_t e) { return tetrahedra[e]; },
                                         .isLeftOut = [&](std::size_t e) { return body->isHeld(tetrahedra[e]); }},
                                        now.positions);
        }
    }
    return count;
}

void followSheaths(SofaScene& scene, physics::TopologyReport& report)
{
    for (const auto& tool : scene.rigid) {
        if (tool->sheath() == 0) continue;
        const engine::ElementsAtBlade now = elementsAtBlades(*tool, scene);
        if (engine::isPushedOn(now, tool->sheath())) ++report.bladeOff;
        if (now.near == 0) tool->setBlades(tool->isCutting(), 0);
    }
}

} // namespace filasofia::sofaengine
