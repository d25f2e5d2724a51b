// Makes an EditableMesh of tetrahedra or of triangles.
#include "filasofia/engine/rupture/editable_mesh.h"

#include "filasofia/engine/rupture/tet_shape.h"
#include "filasofia/geometry/adjacency.h"
#include "filasofia/geometry/box.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

using geometry::Tetrahedron;

/// The triangle across each edge; -1 at the rim. Edge f lies opposite corner f.
std::vector<std::array<int, 4>> sheetNeighbours(const std::vector<geometry::Triangle>& triangles)
{
    struct SheetEdge {
        std::array<int, 2> ends;
        int triangle, edge;
    };
    std::vector<SheetEdge> sides;
    for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
        for (int f = 0; f < 3; ++f) {
            const auto [low, high] = std::minmax(triangles[t][(f + 1) % 3], triangles[t][(f + 2) % 3]);
            sides.push_back({{low, high}, t, f});
        }
    std::ranges::stable_sort(sides, {}, &SheetEdge::ends);
    std::vector<std::array<int, 4>> neighbours(triangles.size(), {-1, -1, -1, -1});
    for (std::size_t i = 1; i < sides.size(); ++i) {
        const SheetEdge &a = sides[i - 1], &b = sides[i];
        if (a.ends != b.ends) continue;
        neighbours[a.triangle][a.edge] = b.triangle;
        neighbours[b.triangle][b.edge] = a.triangle;
    }
    return neighbours;
}

geometry::TetMesh sheetElements(std::vector<Vec3>&& nodes, const std::vector<geometry::Triangle>& triangles)
{
    geometry::TetMesh mesh{std::move(nodes), {}};
    for (const auto& [a, b, c] : triangles) mesh.tetrahedra.push_back({a, b, c, frame::kNoCorner});
    return mesh;
}

} // namespace

EditableMesh::EditableMesh(const geometry::TetMesh& mesh) : EditableMesh(mesh, geometry::faceNeighbours(mesh), 0.0) {}

EditableMesh::EditableMesh(std::vector<Vec3> nodes, const std::vector<geometry::Triangle>& triangles, double thickness)
    : EditableMesh(sheetElements(std::move(nodes), triangles), sheetNeighbours(triangles), thickness)
{
}

EditableMesh::EditableMesh(const geometry::TetMesh& mesh, const std::vector<std::array<int, 4>>& neighbours,
                           double thickness)
    : thickness_(thickness)
{
    // Reserve room for a long cut, so that no step pays for moving all arrays.
    const std::size_t nodeRoom = 2 * mesh.nodes.size() + 1000, room = 2 * mesh.tetrahedra.size() + 1000;
    for (std::vector<Vec3>* list : {&data_.rest, &data_.current, &data_.previous}) list->reserve(nodeRoom);
    data_.around.reserve(nodeRoom);
    data_.labels.reserve(nodeRoom);
    reach_.reserve(nodeRoom);
    for (std::vector<std::uint8_t>* list : {&data_.flagged, &data_.deferred, &data_.opened, &publishedBoundary_})
        list->reserve(room);
    for (std::vector<Tetrahedron>* list : {&data_.tetrahedra, &data_.neighbours, &published_}) list->reserve(room);
    data_.sides.reserve(room);
    data_.tetrahedra.assign(mesh.tetrahedra.begin(), mesh.tetrahedra.end());
    for (std::vector<Vec3>* list : {&data_.rest, &data_.current, &data_.previous})
        list->assign(mesh.nodes.begin(), mesh.nodes.end());
    data_.neighbours.assign(neighbours.begin(), neighbours.end());
    data_.flagged.resize(mesh.tetrahedra.size());
    data_.deferred.resize(mesh.tetrahedra.size());
    data_.opened.resize(mesh.tetrahedra.size());
    data_.gone.resize(mesh.tetrahedra.size());
    data_.sides.resize(mesh.tetrahedra.size());
    data_.around.resize(mesh.nodes.size());
    data_.labels.resize(mesh.nodes.size());
    reach_.resize(mesh.nodes.size());
    geometry::Box box;
    for (Vec3 p : mesh.nodes) box = merged(box, p);
    diagonal_ = distance(box.low, box.high);
    published_.assign(mesh.tetrahedra.begin(), mesh.tetrahedra.end());
    for (int t = 0; t < tetrahedra(); ++t) {
        const Tetrahedron& n = data_.tetrahedra[t];
        startVolume_ += restVolume(data_, t);
        for (auto [i, j] : geometry::kTetrahedronEdges) {
            if (n[i] == frame::kNoCorner || n[j] == frame::kNoCorner) continue;
            const double l = distance(data_.rest[n[i]], data_.rest[n[j]]);
            meanEdge_ += l;
            reach_[n[i]] = std::max(reach_[n[i]], l);
            reach_[n[j]] = std::max(reach_[n[j]], l);
        }
        std::uint8_t boundary = 0;
        for (int node : nodesOf(n)) data_.around[node].push_back(t);
        for (int f = 0; f < 4; ++f)
            if (isBoundaryFace(data_, t, f)) boundary = static_cast<std::uint8_t>(boundary | bit(f));
        publishedBoundary_.push_back(boundary);
    }
    meanEdge_ /= (isSheet() ? 3.0 : 6.0) * tetrahedra();
}

} // namespace filasofia::engine
