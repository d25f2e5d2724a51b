#include "filasofia/engine/body/body_topology.h"

#include "filasofia/engine/rupture/tet_shape.h"

#include <algorithm>
#include <map>
#include <utility>

namespace filasofia::engine {

BodyTopology makeTopology(const SoftModel& model)
{
    BodyTopology topology;
    if (!model.dynamicTopology) return topology;
    if (isRod(model)) {
        topology.start = std::make_unique<SoftModel>(model);
        return topology;
    }
    geometry::TetMesh mesh{model.rest, model.tetrahedra};
    for (const FemElement& element : model.elements) mesh.tetrahedra.push_back(element.nodes);
    topology.mesh = std::make_unique<EditableMesh>(mesh);
    topology.pieces.emplace(topology.mesh->data());
    topology.start = std::make_unique<SoftModel>(model);

    std::map<geometry::Triangle, std::array<int, 2>> faces; // key: the nodes, ascending
    const auto key = [](geometry::Triangle nodes) {
        std::ranges::sort(nodes);
        return nodes;
    };
    const MeshTopology& data = topology.mesh->data();
    for (int e = 0; e < topology.mesh->tetrahedra(); ++e)
        for (int f = 0; f < 4; ++f)
            if (data.neighbours[static_cast<std::size_t>(e)][static_cast<std::size_t>(f)] < 0)
                faces[key(faceNodes(data.tetrahedra[static_cast<std::size_t>(e)], f))] = {e, f};
    topology.boundaryPlaces.assign(mesh.tetrahedra.size(), {-1, -1, -1, -1});
    topology.vertices.assign(model.rest.size(), -1);
    for (const geometry::Triangle& triangle : model.surface) // vertices by ascending node, as in extractSurface()
        for (int node : triangle) topology.vertices[static_cast<std::size_t>(node)] = 0;
    for (int& vertex : topology.vertices)
        if (vertex == 0) vertex = topology.vertexCount++;
    for (const geometry::Triangle& triangle : model.surface) {
        const auto [element, face] = faces.at(key(triangle));
        topology.boundaryPlaces[static_cast<std::size_t>(element)][static_cast<std::size_t>(face)] =
            static_cast<int>(topology.boundaryFaces.size());
        topology.boundaryFaces.push_back({element, face});
    }
    topology.opened.resize(model.surface.size());
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
