#include "filasofia/engine/topology/follow_surface.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

using frame::BoundaryChange;

/// Erases the entries at these places (ascending); the rest keeps its order.
template <class Value> void eraseAt(const std::vector<int>& places, std::vector<Value>& list)
{
    if (places.empty()) return;
    auto kept = static_cast<std::size_t>(places.front());
    for (std::size_t i = kept, next = 0; i < list.size(); ++i) {
        if (next < places.size() && static_cast<std::size_t>(places[next]) == i)
            ++next;
        else
            list[kept++] = list[i];
    }
    list.resize(kept);
}

int& faceIndex(int element, int face, BodyTopology& topology)
{
    return topology.boundaryPlaces[static_cast<std::size_t>(element)][static_cast<std::size_t>(face)];
}

/// Edits the surface. Call finish() once at the end.
class SurfaceChange {
public:
    SurfaceChange(BodyTopology& topology, SoftModel& model) : topology_(topology), model_(model) {}

    void change(int place, const BoundaryChange& to)
    {
        model_.surface[static_cast<std::size_t>(place)] = to.nodes;
        topology_.opened[static_cast<std::size_t>(place)] = to.opened ? 1 : 0;
    }
    /// The places must be ascending.
    void remove(const std::vector<int>& places)
    {
        for (int place : places) {
            const auto [element, face] = topology_.boundaryFaces[static_cast<std::size_t>(place)];
            faceIndex(element, face, topology_) = -1;
        }
        if (!places.empty()) firstMoved_ = std::min(firstMoved_, static_cast<std::size_t>(places.front()));
        eraseAt(places, model_.surface);
        eraseAt(places, topology_.opened);
        eraseAt(places, topology_.boundaryFaces);
    }
    void add(const BoundaryChange& added)
    {
        model_.surface.push_back(added.nodes);
        topology_.opened.push_back(added.opened ? 1 : 0);
        topology_.boundaryFaces.push_back({added.tetrahedron, added.face});
    }
    void finish()
    {
        for (std::size_t t = firstMoved_; t < topology_.boundaryFaces.size(); ++t) {
            const auto [element, face] = topology_.boundaryFaces[t];
            faceIndex(element, face, topology_) = static_cast<int>(t);
        }
        ++topology_.revision;
        topology_.published.reset();
    }

private:
    BodyTopology& topology_;
    SoftModel& model_;
    std::size_t firstMoved_ = topology_.boundaryFaces.size(); ///< the places of earlier triangles are still correct
};

/// The number of a node among the surface's vertices. A node without one gets a new number.
int vertexOf(int node, const SoftModel& model, BodyTopology& topology, OwnSurfaceEdit& out)
{
    int& vertex = topology.vertices[static_cast<std::size_t>(node)];
    if (vertex < 0) {
        vertex = topology.vertexCount++;
        out.nodes.push_back(node);
        out.surface.vertices.push_back(model.rest[static_cast<std::size_t>(node)]);
    }
    return vertex;
}

} // namespace

OwnSurfaceEdit followSurface(const frame::TopologyEdit& edit, BodyTopology& topology, SoftModel& model)
{
    using Kind = BoundaryChange::Kind;
    topology.vertices.resize(model.rest.size(), -1);
    topology.boundaryPlaces.resize(static_cast<std::size_t>(edit.tetrahedra), {-1, -1, -1, -1});
    OwnSurfaceEdit out;
    std::vector<std::pair<int, const BoundaryChange*>> changed;
    for (const BoundaryChange& change : edit.boundary) {
        const int place = faceIndex(change.tetrahedron, change.face, topology);
        if (change.kind == Kind::Removed) out.surface.removed.push_back(place);
        if (change.kind == Kind::Changed) changed.emplace_back(place, &change);
    }
    std::ranges::sort(out.surface.removed);
    std::ranges::sort(changed, {}, &std::pair<int, const BoundaryChange*>::first);

    const auto inVertices = [&](geometry::Triangle triangle) {
        for (int& node : triangle) node = vertexOf(node, model, topology, out);
        return triangle;
    };
    SurfaceChange surface(topology, model);
    for (const auto& [place, change] : changed) {
        surface.change(place, *change);
        out.surface.changed.emplace_back(place, inVertices(change->nodes));
    }
    surface.remove(out.surface.removed);
    for (const BoundaryChange& change : edit.boundary) {
        if (change.kind != Kind::Added) continue;
        surface.add(change);
        out.surface.added.push_back(inVertices(change.nodes));
    }
    surface.finish();
    for (const auto& [element, face] : topology.boundaryFaces)
        out.behind.push_back(cornerBehind(element, face, topology));
    return out;
}

OwnSurfaceEdit takeOffSurface(const std::vector<char>& elements, BodyTopology& topology, SoftModel& model)
{
    OwnSurfaceEdit out;
    for (std::size_t t = 0; t < topology.boundaryFaces.size(); ++t)
        if (elements[static_cast<std::size_t>(topology.boundaryFaces[t][0])] != 0)
            out.surface.removed.push_back(static_cast<int>(t));
    SurfaceChange surface(topology, model);
    surface.remove(out.surface.removed);
    surface.finish();
    return out;
}

void editOwnCollision(const OwnSurfaceEdit& surface, SoftModel& model, Scene& scene)
{
    for (int m = 0; m < static_cast<int>(model.collision.size()); ++m)
        if (model.collision[static_cast<std::size_t>(m)].own) editCollision(surface, m, model, scene);
}

} // namespace filasofia::engine
