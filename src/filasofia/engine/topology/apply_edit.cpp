#include "filasofia/engine/topology/apply_edit.h"

#include "filasofia/core/sorted.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/rupture/keep_momentum.h"
#include "filasofia/engine/rupture/pin_new_nodes.h"
#include "filasofia/engine/topology/follow_surface.h"

#include <algorithm>
#include <map>
#include <utility>

namespace filasofia::engine {
namespace {

using frame::TopologyEdit;

/// Elements that are new or have other nodes or another shape, ascending: those that the edit names, and those around
/// nodes that slid and around their copies.
std::vector<int> reachedElements(const TopologyEdit& edit, const MeshTopology& mesh)
{
    std::vector<int> elements, slid;
    for (const frame::TetNodes& changed : edit.changed) elements.push_back(changed.tetrahedron);
    for (const frame::TopologyOp& op : edit.ops) {
        if (const auto* moved = std::get_if<frame::NodeMove>(&op)) slid.push_back(moved->node);
        const auto* copy = std::get_if<frame::NodeCopy>(&op);
        if (copy && std::ranges::find(slid, copy->from) != slid.end()) slid.push_back(copy->copy);
    }
    for (int node : slid) {
        const std::vector<int>& around = mesh.around[static_cast<std::size_t>(node)];
        elements.insert(elements.end(), around.begin(), around.end());
    }
    sortUnique(elements);
    return elements;
}

/// Adds the triangles beside these: how they bend depends on the corners across their edges.
void addNeighbours(const MeshTopology& mesh, std::vector<int>& triangles)
{
    const std::size_t count = triangles.size();
    for (std::size_t i = 0; i < count; ++i)
        for (int other : mesh.neighbours[static_cast<std::size_t>(triangles[i])])
            if (other >= 0) triangles.push_back(other);
    sortUnique(triangles);
}

/// The nodes of these elements before and after the edit, ascending.
std::vector<int> reachedNodes(const std::vector<int>& elements, const MeshTopology& mesh, const SoftModel& model)
{
    std::vector<int> nodes;
    for (int element : elements) {
        const auto e = static_cast<std::size_t>(element);
        const auto add = [&](const geometry::Tetrahedron& of) {
            for (int node : nodesOf(of)) nodes.push_back(node);
        };
        add(mesh.tetrahedra[e]);
        if (e < elementCount(model)) add(elementNodes(model, e));
    }
    sortUnique(nodes);
    return nodes;
}

/// A new node between two pinned nodes is pinned, and a copy of one. Spring pins stay with the original node and slide
/// with it.
void followPins(const TopologyEdit& edit, SoftModel& model)
{
    Pins& pins = model.pins;
    const auto add = [&](int node, int a, int b) {
        const bool held = pins.hard[static_cast<std::size_t>(a)] && pins.hard[static_cast<std::size_t>(b)];
        pins.hard.push_back(held);
        if (held) pinBetween(a, b, pins.groups, [&](PinGroup& group) { group.nodes.push_back(node); });
    };
    for (const frame::TopologyOp& op : edit.ops)
        if (const auto* made = std::get_if<frame::NewNode>(&op)) {
            add(made->node, made->a, made->b);
        } else if (const auto* copy = std::get_if<frame::NodeCopy>(&op)) {
            add(copy->copy, copy->from, copy->from);
        } else if (const auto* moved = std::get_if<frame::NodeMove>(&op)) {
            for (PinSpring& pin : pins.springs)
                if (pin.node == moved->node) pin.anchor += moved->newRest - moved->oldRest;
        }
}

void followState(const TopologyEdit& edit, const MeshTopology& mesh, SoftModel& model, SoftState& state)
{
    frame::followNodes(edit, state.v);
    frame::followNodes(edit, state.dv);
    const auto count = static_cast<std::size_t>(edit.nodes), known = model.rest.size();
    model.rest.insert(model.rest.end(), mesh.rest.begin() + static_cast<std::ptrdiff_t>(known), mesh.rest.end());
    state.x.insert(state.x.end(), mesh.current.begin() + static_cast<std::ptrdiff_t>(known), mesh.current.end());
    for (const frame::TopologyOp& op : edit.ops)
        if (const auto* moved = std::get_if<frame::NodeMove>(&op)) { // also of nodes that the edit has made
            const auto node = static_cast<std::size_t>(moved->node);
            model.rest[node] = mesh.rest[node];
            state.x[node] = mesh.current[node];
        }
    state.residual.resize(count); // residual impulses and forces stay with their nodes
    state.forces.resize(count);
    model.masses.resize(count);
    if (!model.filling.empty()) model.filling.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        if (model.pins.hard[i]) state.v[i] = state.dv[i] = {};
}

/// Adds (sign 1) or subtracts (sign -1) the element's mass at its nodes.
void addMass(const SoftModel& model, std::size_t element, double sign, std::vector<double>& masses)
{
    const geometry::Tetrahedron nodes = elementNodes(model, element);
    const double density = model.elements.empty() ? model.density : model.elements[element].density;
    const double massPerNode =
        isShell(model) ? model.density * model.shell.material.thickness / 3.0 * model.shell.membranes[element].area
                       : 0.25 * density * volumeOf(cornersOf(nodes, model.rest));
    for (int node : nodesOf(nodes)) masses[static_cast<std::size_t>(node)] += sign * massPerNode;
}

/// Appends the children of divided elements, which inherit their parents' material, rotation and relaxation.
void addElements(const TopologyEdit& edit, SoftModel& model, SoftState& state)
{
    const bool fem = !model.elements.empty();
    for (const frame::TopologyOp& op : edit.ops) {
        const auto* split = std::get_if<frame::TetSplit>(&op);
        if (!split || isShell(model)) continue;
        if (!fem) {
            model.tetrahedra.emplace_back();
            continue;
        }
        const auto parent = static_cast<std::size_t>(split->parent), child = static_cast<std::size_t>(split->child);
        model.elements.push_back(FemElement(model.elements[parent]));
        for (std::vector<Vec3>& directions : model.fibres) directions.push_back(Vec3(directions[parent]));
        const auto blocks = static_cast<std::size_t>(linalg::blocksFor(static_cast<int>(model.elements.size())));
        state.rotations.resize(blocks);
        setRotation(state.rotations, child, rotationOf(state.rotations, parent));
        if (state.relaxation.empty()) continue;
        state.relaxation.resize(blocks);
        copyRelaxation(parent, child, state.relaxation);
    }
}

/// Rebuilds the springs on edges between nodes that the edit reached; the others stay.
void followSprings(const std::vector<int>& reached, const MeshTopology& mesh, SoftModel& model)
{
    const auto isReached = [&](int node) { return std::ranges::binary_search(reached, node); };
    std::vector<std::array<int, 2>> edges;
    for (int a : reached)
        for (int t : mesh.around[static_cast<std::size_t>(a)])
            for (int b : mesh.tetrahedra[static_cast<std::size_t>(t)])
                if (a < b && isReached(b)) edges.push_back({a, b});
    sortUnique(edges);
    const Spring like = model.springs.front();
    std::vector<Spring> created, kept, all;
    for (const std::array<int, 2>& edge : edges) created.push_back(springOn(edge, like, model.rest));
    std::ranges::copy_if(model.springs, std::back_inserter(kept), [&](const Spring& spring) {
        return !isReached(spring.nodes[0]) || !isReached(spring.nodes[1]);
    });
    std::ranges::merge(kept, created, std::back_inserter(all), {}, &Spring::nodes, &Spring::nodes);
    model.springs = std::move(all);
}

/// The corner of the triangle across an edge of a sheet that is not on the edge; -1 if there is none.
int cornerAcross(const MeshTopology& mesh, std::size_t triangle, std::size_t edge)
{
    const int other = mesh.neighbours[triangle][edge];
    if (other < 0) return -1;
    const geometry::Tetrahedron& own = mesh.tetrahedra[triangle];
    for (int node : nodesOf(mesh.tetrahedra[static_cast<std::size_t>(other)]))
        if (node != own[(edge + 1) % 3] && node != own[(edge + 2) % 3]) return node;
    return -1;
}

/// Shapes the triangles of a shell again, with their angles at rest; new ones are of their parents' triangles.
void followTriangles(const TopologyEdit& edit, const std::vector<int>& triangles, const MeshTopology& mesh,
                     SoftModel& model)
{
    std::vector<std::size_t> parents;
    const std::size_t known = model.shell.membranes.size();
    for (const frame::TopologyOp& op : edit.ops)
        if (const auto* split = std::get_if<frame::TetSplit>(&op))
            parents.push_back(static_cast<std::size_t>(split->parent));
    for (int each : triangles) { // ascending: parents come before their children
        const auto t = static_cast<std::size_t>(each);
        const auto& [a, b, c, none] = mesh.tetrahedra[t];
        TriangleEdit to{.triangle = t, .nodes = {a, b, c}};
        if (t >= known) to.parent = parents[t - known];
        for (std::size_t f = 0; f < 3; ++f) to.across[f] = cornerAcross(mesh, t, f);
        shapeTriangle(to, model.rest, model.shell);
        addMass(model, t, 1.0, model.masses);
    }
}

void followElements(const TopologyEdit& edit, const MeshEdit& changed, const MeshTopology& mesh, SoftModel& model,
                    SoftState& state)
{
    if (isShell(model)) return followTriangles(edit, changed.elements, mesh, model);
    addElements(edit, model, state);
    for (int element : changed.elements) {
        const auto e = static_cast<std::size_t>(element);
        setElementNodes(mesh.tetrahedra[e], e, model);
        addMass(model, e, 1.0, model.masses);
        if (!model.elements.empty()) shapeElement(model.rest, model.elements[e]);
    }
    if (model.elements.empty()) followSprings(changed.reached, mesh, model);
}

MeshEdit meshEdit(const TopologyEdit& edit, const MeshTopology& mesh, const SoftModel& model)
{
    MeshEdit out{.nodes = {}, .elements = reachedElements(edit, mesh), .reached = {}};
    if (isShell(model)) addNeighbours(mesh, out.elements);
    out.reached = reachedNodes(out.elements, mesh, model);
    for (const frame::TopologyOp& op : edit.ops)
        if (const auto* made = std::get_if<frame::NewNode>(&op))
            out.nodes.push_back({made->a, made->b, made->s});
        else if (const auto* copy = std::get_if<frame::NodeCopy>(&op))
            out.nodes.push_back({copy->from, copy->from, 0.0});
    return out;
}

/// The faces of a divided element are those of its parent; the faces between the two halves are no wall.
void followWalls(const TopologyEdit& edit, BodyTopology& topology)
{
    if (topology.wallOf.empty()) return;
    for (const frame::TopologyOp& op : edit.ops) {
        const auto* split = std::get_if<frame::TetSplit>(&op);
        if (!split) continue;
        const auto parent = static_cast<std::size_t>(split->parent);
        topology.wallOf.push_back(std::array(topology.wallOf[parent]));
        topology.wallOf[parent][static_cast<std::size_t>(split->ia)] = -1;
        topology.wallOf.back()[static_cast<std::size_t>(split->ib)] = -1;
    }
}

void followSystem(const MeshEdit& edit, double period, const SoftModel& model, SoftSystem& system)
{
    if (!system.matrixFree) { // rebuild the matrix
        system = makeSystem(model, period);
        system.tuned = true;
        return;
    }
    if (system.matrixFree->edit(model, edit)) system.coupled.reset();
    for (auto* buffer : {&system.forces, &system.x, &system.v, &system.dv, &system.residual})
        buffer->resize(model.rest.size());
    updatePinnedParts(model, edit, system.held);
    system.tuned = true; // no longer as its Def describes it
}

} // namespace

OwnSurfaceEdit applyEdit(const TopologyEdit& edit, double period, SoftBody& body)
{
    auto& [model, state, system, topology] = body;
    const MeshTopology& mesh = topology.mesh->data();
    const MeshEdit changed = meshEdit(edit, mesh, model);
    const Vec3 momentum = momentumOf(changed.reached, model.masses, state.v);
    for (int element : changed.elements)
        if (const auto e = static_cast<std::size_t>(element); e < elementCount(model))
            addMass(model, e, -1.0, model.masses);

    const auto opens = [](const frame::TopologyOp& op) { return std::holds_alternative<frame::NodeCopy>(op); };
    model.opened = model.opened || std::ranges::any_of(edit.ops, opens);
    model.leaks = model.leaks || (topology.closed && model.opened);
    followPins(edit, model);
    followState(edit, mesh, model, state);
    followElements(edit, changed, mesh, model, state);
    topology.springs = {};
    followWalls(edit, topology);
    OwnSurfaceEdit surface = followSurface(edit, topology, model);
    followSystem(changed, period, model, system);
    keepMomentum(
        momentum, changed.reached, model.masses,
        [&pins = model.pins](int node) { return pins.hard[static_cast<std::size_t>(node)]; }, state.v);
    return surface;
}

} // namespace filasofia::engine
