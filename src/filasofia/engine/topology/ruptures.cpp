#include "filasofia/engine/topology/ruptures.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/log.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/contact/clip_holds.h"
#include "filasofia/engine/topology/apply_edit.h"
#include "filasofia/engine/topology/cut_attachments.h"
#include "filasofia/engine/topology/cut_rods.h"
#include "filasofia/engine/topology/follow_edit.h"
#include "filasofia/engine/topology/follow_surface.h"
#include "filasofia/engine/topology/loose_pieces.h"
#include "filasofia/engine/topology/remove_piece.h"
#include "filasofia/engine/topology/tear_body.h"
#include "filasofia/physics/limits.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace filasofia::engine {
namespace {

using physics::Rupture;

std::vector<std::array<int, 2>> linesOf(const CollisionShape& shape)
{
    return cuttingEdges({shape.rest, shape.triangles, {}}, shape.edges, shape.edgeTriangles);
}

/// Updates the current and previous positions of every blade. A blade that jumped has no path and cuts nothing.
void moveBlades(const RigidPlan& rigid, const Scene& scene, std::vector<Blade>& blades)
{
    std::vector<Blade> next;
    const std::vector<std::size_t> first = firstElements(scene);
    for (std::size_t b = 0; b < scene.rigid.size(); ++b)
        for (int m = 0; const CollisionModel& each : scene.rigid[b].model.collision) {
            const SurfaceName name{scene.rigid[b].model.id, m++};
            if (!each.shape->cutting || !scene.rigid[b].state.cutting) continue;
            const auto known = std::ranges::find(blades, name, &Blade::name);
            const bool same = known != blades.end() && known->shape == each.shape;
            Blade& blade = next.emplace_back(same ? std::move(*known) : Blade{name, each.shape, linesOf(*each.shape)});
            const auto element = static_cast<std::size_t>(each.element);
            const RigidPlanElement& plan = rigid[first[b] + element];
            // An element whose plan has no velocity stands still or jumped.
            const bool moved =
                plan.velocity + plan.change.linear != Vec3{} || plan.angularVelocity + plan.change.angular != Vec3{};
            const Pose& pose = scene.rigid[b].state.poses[element];
            blade.jumped = !moved && plan.start != pose;
            blade.before.clear();
            blade.now.clear();
            blade.swept = {};
            for (const Vec3& vertex : each.shape->rest) {
                blade.now.push_back(transform(pose, vertex));
                blade.before.push_back(transform(moved ? plan.start : pose, vertex));
                blade.swept = merged(merged(blade.swept, blade.now.back()), transform(plan.start, vertex));
            }
        }
    blades = std::move(next);
}

/// Bounding box of the remaining pieces. Removed pieces have no surface.
geometry::Box boxOf(const SoftModel& model, const SoftState& state)
{
    if (model.removed.empty()) return geometry::boxAround(state.x);
    geometry::Box box;
    for (const geometry::Triangle& triangle : model.surface)
        for (int node : triangle) box = merged(box, state.x[static_cast<std::size_t>(node)]);
    return box;
}

/// Sorted by body, ascending.
std::vector<Tool> toolsNear(SoftBody& body, const std::vector<Blade>& blades, physics::TopologyReport& report)
{
    const SoftModel& model = body.model;
    BodyTopology& topology = body.topology;
    std::vector<Tool> tools;
    geometry::Box box;
    const double margin = topology.mesh->meanEdge();
    for (const Blade& blade : blades) {
        if (!mayBeCut(model, blade.shape->group)) continue;
        if (geometry::isEmpty(box)) {
            MovingBounds& around = topology.around;
            around.margin += topology.mesh->lastMotion();
            if (!topology.followed || !(around.margin < 0.5 * margin)) around = {boxOf(model, body.state)};
            box = geometry::grown(around.box, margin + around.margin);
        }
        const auto isNear = [&](const std::vector<Vec3>& vertices) {
            const geometry::Box around = geometry::boxAround(vertices);
            return overlap(around, box) || isEmpty(around); // not finite: the stroke refuses it and counts that
        };
        if (blade.jumped && overlap(blade.swept, box)) ++report.bladeTooFast;
        if (!isNear(blade.now) && !isNear(blade.before)) continue;
        if (tools.empty() || tools.back().body != blade.name.body) tools.push_back({blade.name.body, {}});
        addBlade({blade.lines, blade.before, blade.now}, tools.back());
    }
    return tools;
}

/// Tells once of a tool whose cut was too small for the mesh to show it.
void tellInVain(BodyId tool, const Scene& scene, SoftBody& body)
{
    std::vector<BodyId>& told = body.topology.toldInVain;
    if (std::ranges::find(told, tool) != told.end()) return;
    told.push_back(tool);
    logWarning(nameOf(scene, tool), ": its blade went through edges of ", describe(body.model),
               " and opened nothing: the cut was smaller than elements of ",
               std::round(1e4 * body.topology.mesh->meanEdge()) / 10.0, " mm show");
}

/// Lets every tool near a body cut it.
void cutBody(const Scene& scene, SoftBody& body, const std::vector<Blade>& blades, physics::TopologyReport& report)
{
    const SoftState& state = body.state;
    BodyTopology& topology = body.topology;
    EditableMesh& mesh = *topology.mesh;
    std::vector<Stroke>& strokes = topology.strokes;
    const std::vector<Tool> tools = toolsNear(body, blades, report);
    beginStrokes(tools, mesh, strokes);
    const bool followed = std::exchange(topology.followed, !strokes.empty());
    if (strokes.empty()) return;
    if (followed)
        mesh.moveTo(state.x);
    else
        mesh.placeAt(state.x);
    std::vector<BodyId> cutters;
    for (const Stroke& each : strokes) cutters.push_back(each.tool);
    auto cutter = cutters.begin();
    for (const RuptureReport& done : cutWith(tools, mesh, strokes)) {
        topology.cut += done;
        add(done, report);
        if (done.inVain > 0) tellInVain(*cutter, scene, body);
        ++cutter;
    }
}

std::vector<physics::LoosePiece> loosePieces(const frame::TopologyEdit& edit, BodyTopology& topology)
{
    std::vector<physics::LoosePiece> loose;
    for (DetachedPiece& piece : topology.pieces->update(topology.mesh->data(), edit))
        loose.push_back({piece.id, std::move(piece.tetrahedra)});
    return loose;
}

/// What a piece is of the whole body; its mass [kg] remains in the model when it is removed.
physics::LostPiece lossOf(int piece, const SoftModel& model)
{
    const auto found = std::ranges::find(model.pieces, piece, &BodyPiece::number);
    FILASOFIA_ASSERT(found != model.pieces.end());
    physics::LostPiece loss{.body = model.id, .piece = piece};
    for (const int node : found->nodes) loss.mass += model.masses[static_cast<std::size_t>(node)];
    loss.share = loss.mass / std::accumulate(model.masses.begin(), model.masses.end(), 0.0);
    return loss;
}

} // namespace

void removeLostPieces(Scene& scene, physics::StepReport& report)
{
    for (SoftBody& body : scene.soft) {
        const int before = report.topology.lost;
        for (int piece : piecesBeyond(physics::kLostDistance, body.model, body.state)) {
            const physics::LostPiece loss = lossOf(piece, body.model);
            if (!removePiece(piece, body, scene, report)) continue;
            ++report.topology.lost;
            report.topology.lostPieces.push_back(loss);
        }
        if (report.topology.lost == before) continue;
        body.system.outdated = true; // rebuilt in the next step, with what its commands change
        body.system.tuned = true;    // no longer as its Def describes it
    }
}

void cutBodies(const StepContext& context, const RigidPlan& rigid, Scene& scene, std::vector<Blade>& blades)
{
    if (context.dt == 0.0) return;
    moveBlades(rigid, scene, blades);
    for (SoftBody& body : scene.soft) {
        if (!body.model.dynamicTopology) continue;
        if (isRod(body.model))
            findRodCuts(blades, body, context.report.topology);
        else
            cutBody(scene, body, blades, context.report.topology);
    }
    cutAttachments(blades, scene);
}

void tearBodies(const StepContext& context, Scene& scene)
{
    if (context.dt == 0.0) return;
    for (SoftBody& body : scene.soft) {
        if (!body.model.dynamicTopology) continue;
        if (isRod(body.model))
            findRodTears(body);
        else
            tearBody(body, context.pool, context.report.topology);
    }
}

namespace {

/// Brings one body, and everything that rides on it, in line with the edits of its mesh.
void applyEditsOf(SoftBody& body, double period, Scene& scene, physics::TopologyReport& report)
{
    BodyTopology& topology = body.topology;
    if (isRod(body.model)) return applyRodCuts(body, scene, report);
    if (!topology.mesh || !topology.mesh->edited()) return;
    SoftModel& model = body.model;
    const frame::TopologyEdit edit = topology.mesh->takeEdit(model.id);
    const auto nodes = static_cast<int>(model.rest.size());
    const auto elements = static_cast<int>(elementCount(model));
    if (!std::exchange(topology.edited, true)) topology.startAttachments = scene.attachments;
    topology.history = historyWith(edit, topology.history);
    followRiders(edit, *topology.mesh, model, body.state.clips, scene.attachments, scene.channels);
    followHolds(body.state.clips, scene.attachments);
    const OwnSurfaceEdit surface = applyEdit(edit, period, body);
    std::vector<physics::LoosePiece> loose = loosePieces(edit, topology);
    model.pieces = findPieces(model, *topology.pieces);
    measure(model, body.state, loose);
    if (edit.boundary.empty()) return;
    editOwnCollision(surface, model, scene);
    std::vector<int> cavities = followCavities(topology, model);

    std::vector<Rupture>& reported = report.ruptures;
    const std::size_t before = reported.size();
    moveRupture(Rupture::Kind::Cut, model.id, topology.cut, report);
    moveRupture(Rupture::Kind::Tear, model.id, topology.torn, report);
    if (reported.size() == before) return;
    reported[before].nodes = edit.nodes - nodes;
    reported[before].elements = edit.tetrahedra - elements;
    reported.back().detached = std::move(loose);
    reported.back().cavities = std::move(cavities);
}

} // namespace

void applyEdits(double period, Scene& scene, physics::StepReport& report)
{
    for (SoftBody& body : scene.soft) applyEditsOf(body, period, scene, report.topology);
}

void followPartings(double dt, Scene& scene, BackgroundThread& meanwhile)
{
    if (dt == 0.0) return;
    for (SoftBody& body : scene.soft)
        if (body.system.matrixFree && !body.system.outdated)
            body.system.matrixFree->followParting(body.model, meanwhile);
}

} // namespace filasofia::engine
