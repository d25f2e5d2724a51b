#include "filasofia/engine/body/body_topology.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>
#include <map>
#include <utility>

namespace filasofia::engine {
namespace {

std::unique_ptr<EditableMesh> makeMesh(const SoftModel& model)
{
    if (!isShell(model)) {
        geometry::TetMesh mesh{model.rest, model.tetrahedra};
        for (const FemElement& element : model.elements) mesh.tetrahedra.push_back(element.nodes);
        return std::make_unique<EditableMesh>(mesh);
    }
    std::vector<geometry::Triangle> triangles;
    for (const MembraneElement& each : model.shell.membranes) triangles.push_back(each.nodes);
    return std::make_unique<EditableMesh>(model.rest, triangles, model.shell.material.thickness);
}

/// A shell without a rim.
bool isClosed(const SoftModel& model, const MeshTopology& mesh)
{
    return isShell(model) && std::ranges::none_of(mesh.neighbours, [](const std::array<int, 4>& beside) {
               return std::ranges::count(beside, -1) > 1; // there is none across the triangle itself
           });
}

geometry::Triangle ascending(geometry::Triangle nodes)
{
    std::ranges::sort(nodes);
    return nodes;
}

/// Element and face of each triangle of the boundary, by its nodes.
std::map<geometry::Triangle, std::array<int, 2>> boundaryFaces(const MeshTopology& mesh)
{
    std::map<geometry::Triangle, std::array<int, 2>> faces;
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
        for (int f = 0; f < 4; ++f)
            if (isBoundaryFace(mesh, static_cast<int>(e), f))
                faces[ascending(faceNodes(mesh.tetrahedra[e], f))] = {static_cast<int>(e), f};
    return faces;
}

} // namespace

BodyTopology makeTopology(const SoftModel& model)
{
    BodyTopology topology;
    if (!model.dynamicTopology) return topology;
    if (isRod(model)) {
        topology.start = std::make_unique<SoftModel>(model);
        return topology;
    }
    topology.mesh = makeMesh(model);
    topology.closed = isClosed(model, topology.mesh->data());
    topology.pieces.emplace(topology.mesh->data());
    topology.start = std::make_unique<SoftModel>(model);

    const MeshTopology& data = topology.mesh->data();
    const std::map<geometry::Triangle, std::array<int, 2>> faces = boundaryFaces(data);
    topology.boundaryPlaces.assign(data.tetrahedra.size(), {-1, -1, -1, -1});
    topology.vertices.assign(model.rest.size(), -1);
    for (const geometry::Triangle& triangle : model.surface) // vertices by ascending node, as in extractSurface()
        for (int node : triangle) topology.vertices[static_cast<std::size_t>(node)] = 0;
    for (int& vertex : topology.vertices)
        if (vertex == 0) vertex = topology.vertexCount++;
    for (const geometry::Triangle& triangle : model.surface) {
        const auto [element, face] = faces.at(ascending(triangle));
        topology.boundaryPlaces[static_cast<std::size_t>(element)][static_cast<std::size_t>(face)] =
            static_cast<int>(topology.boundaryFaces.size());
        topology.boundaryFaces.push_back({element, face});
    }
    topology.opened.resize(model.surface.size());
    if (model.cavities.empty()) return topology;
    topology.wallOf.assign(data.tetrahedra.size(), {-1, -1, -1, -1});
    for (std::size_t t = 0; t < model.wallOf.size(); ++t) {
        const auto [element, face] = topology.boundaryFaces[t];
        topology.wallOf[static_cast<std::size_t>(element)][static_cast<std::size_t>(face)] = model.wallOf[t];
    }
    return topology;
}

int cornerBehind(int element, int face, const BodyTopology& topology)
{
    return topology.mesh->data().tetrahedra[static_cast<std::size_t>(element)][static_cast<std::size_t>(face)];
}

std::shared_ptr<const frame::Boundary> boundaryOf(const SoftModel& model, const BodyTopology& topology)
{
    if (!topology.mesh || topology.published) return topology.published;
    frame::Boundary boundary{
        .revision = topology.revision, .triangles = model.surface, .opened = topology.opened, .rest = model.rest};
    for (const auto& [element, face] : topology.boundaryFaces)
        boundary.behind.push_back(cornerBehind(element, face, topology));
    topology.published = std::make_shared<const frame::Boundary>(std::move(boundary));
    return topology.published;
}

} // namespace filasofia::engine
