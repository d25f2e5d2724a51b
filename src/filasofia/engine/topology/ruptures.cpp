#include "filasofia/engine/topology/ruptures.h"

#include "filasofia/core/hash.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/contact/clip_holds.h"
#include "filasofia/engine/topology/apply_edit.h"
#include "filasofia/engine/topology/cut_attachments.h"
#include "filasofia/engine/topology/cut_rods.h"
#include "filasofia/engine/topology/follow_edit.h"
#include "filasofia/engine/topology/follow_surface.h"
#include "filasofia/engine/topology/loose_pieces.h"
#include "filasofia/engine/topology/remove_piece.h"
#include "filasofia/engine/topology/tear_body.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

using physics::Rupture;

/// The edges of a blade that cut: boundary edges, those with at most one triangle. If a mesh has none (it is closed),
/// the edges sharper than a right angle cut; if it has none of these either, all edges do.
std::vector<std::array<int, 2>> linesOf(const CollisionShape& shape)
{
    const auto normalOf = [&](int triangle) {
        const auto [a, b, c] = shape.triangles[static_cast<std::size_t>(triangle)];
        const auto at = [&](int vertex) { return shape.rest[static_cast<std::size_t>(vertex)]; };
        return normalized(cross(at(b) - at(a), at(c) - at(a)));
    };
    std::vector<std::array<int, 2>> open, sharp;
    for (std::size_t e = 0; e < shape.edges.size(); ++e) {
        const auto beside = shape.edgeTriangles[e];
        if (beside.size() < 2)
            open.push_back(shape.edges[e]);
        else if (dot(normalOf(beside[0]), normalOf(beside[1])) < 1e-9)
            sharp.push_back(shape.edges[e]);
    }
    return !open.empty() ? open : !sharp.empty() ? sharp : shape.edges;
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

/// All blades of one rigid body near a soft body: both jaws of scissors cut one surface.
struct Tool {
    BodyId body;
    std::vector<BladeSegment> segments;
    double way = 0.0; ///< [m] longest path of a vertex in the step
};

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
        Tool& tool = tools.back();
        for (const auto& [a, b] : blade.lines) {
            const auto from = static_cast<std::size_t>(a), to = static_cast<std::size_t>(b);
            tool.segments.push_back({blade.now[from], blade.now[to], blade.before[from], blade.before[to]});
        }
        for (std::size_t i = 0; i < blade.now.size(); ++i)
            tool.way = std::max(tool.way, distance(blade.now[i], blade.before[i]));
    }
    return tools;
}

/// Performs one step of a stroke. `tool` is null if the tool is no longer near the body.
RuptureReport continueStroke(EditableMesh& mesh, const Tool* tool, Stroke& stroke)
{
    RuptureReport done;
    const CutParameters parameters = parametersFor(mesh);
    if (!stroke.leaving && tool) {
        done = stroke.stroke.step(mesh, tool->segments, parameters);
        stroke.sinceCrossing = done.crossings > 0 ? 0.0 : stroke.sinceCrossing + tool->way;
        stroke.hasCut = stroke.hasCut || done.crossings > 0;
        if (!stroke.arrived && !stroke.stroke.away()) { // a returning blade continues the surface that it finds
            stroke.arrived = true;
            const int sheet = stroke.hasCut ? 0 : sheetAt(mesh, tool->segments);
            if (sheet > 0) stroke.stroke = BladeStroke(sheet);
        }
    }
    const bool through = stroke.hasCut && (stroke.stroke.away() || stroke.sinceCrossing > 2.0 * mesh.meanEdge());
    stroke.leaving = stroke.leaving || !tool || through;
    if (stroke.leaving) stroke.over = stroke.stroke.finish(mesh, parameters, done);
    return done;
}

/// Lets every tool near a body cut it. A stroke ends after its blades have moved two mean edges without crossing
/// anything, or are away from the body. What they cut later is a new cut.
void cutBody(SoftBody& body, const std::vector<Blade>& blades, physics::TopologyReport& report)
{
    const SoftState& state = body.state;
    BodyTopology& topology = body.topology;
    EditableMesh& mesh = *topology.mesh;
    std::vector<Stroke>& strokes = topology.strokes;
    const std::vector<Tool> tools = toolsNear(body, blades, report);
    for (const Tool& tool : tools) {
        const auto isItsOwn = [&](const Stroke& stroke) { return stroke.tool == tool.body && !stroke.leaving; };
        if (std::ranges::none_of(strokes, isItsOwn)) strokes.push_back({tool.body, BladeStroke(mesh.newSheet())});
    }
    const bool followed = std::exchange(topology.followed, !strokes.empty());
    if (strokes.empty()) return;
    if (followed)
        mesh.moveTo(state.x);
    else
        mesh.placeAt(state.x);
    for (Stroke& stroke : strokes) {
        const auto tool = std::ranges::find(tools, stroke.tool, &Tool::body);
        const RuptureReport done = continueStroke(mesh, tool == tools.end() ? nullptr : &*tool, stroke);
        topology.cut += done;
        add(done, report);
    }
    std::erase_if(strokes, [](const Stroke& stroke) { return stroke.over; });
}

/// Hash of all edits so far: if two histories are equal, the meshes are equal.
std::uint64_t historyWith(const frame::TopologyEdit& edit, std::uint64_t before)
{
    Hasher hash;
    hash.add(before);
    static_assert(sizeof(frame::TetNodes) == 5 * sizeof(int)); // no padding: all bytes are numbers
    hash.addAll(std::span<const frame::TetNodes>(edit.changed));
    for (const frame::TopologyOp& op : edit.ops)
        if (const auto* made = std::get_if<frame::NewNode>(&op))
            hash.add(made->s);
        else if (const auto* moved = std::get_if<frame::NodeMove>(&op))
            for (double each : {moved->newRest.x, moved->newRest.y, moved->newRest.z}) hash.add(each);
    return hash.value();
}

std::vector<physics::LoosePiece> loosePieces(const frame::TopologyEdit& edit, BodyTopology& topology)
{
    std::vector<physics::LoosePiece> loose;
    for (DetachedPiece& piece : topology.pieces->update(topology.mesh->data(), edit))
        loose.push_back({piece.id, std::move(piece.tetrahedra)});
    return loose;
}

void reportRupture(Rupture::Kind kind, BodyId body, RuptureReport& opened, std::vector<Rupture>& ruptures)
{
    if (opened.openedArea > 0.0)
        ruptures.push_back({.kind = kind,
                            .body = body,
                            .place = 1.0 / opened.openedArea * opened.openedMoment,
                            .area = opened.openedArea});
    opened = {};
}

constexpr double kLostDistance = 10.0; // [m] displacement at which a piece counts as having fallen out of the scene

} // namespace

void removeLostPieces(Scene& scene, physics::StepReport& report)
{
    for (SoftBody& body : scene.soft) {
        int lost = 0;
        for (int piece : piecesBeyond(kLostDistance, body.model, body.state))
            lost += removePiece(piece, body, scene, report) ? 1 : 0;
        if (lost == 0) continue;
        report.topology.lost += lost;
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
            cutBody(body, blades, context.report.topology);
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
    reportRupture(Rupture::Kind::Cut, model.id, topology.cut, reported);
    reportRupture(Rupture::Kind::Tear, model.id, topology.torn, reported);
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
