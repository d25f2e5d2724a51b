#include "filasofia/geometry/adjacency.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/sorted.h"
#include "filasofia/geometry/face_list.h"

#include <algorithm>
#include <numeric>

namespace filasofia::geometry {
namespace {

// Counts, sums up, then fills: `each(visit)` calls visit(row, item) in the same order on both passes.
template <class Each> CompressedRows compress(std::size_t rowCount, const Each& each)
{
    CompressedRows rows;
    rows.start.assign(rowCount + 1, 0);
    each([&](int row, int) { ++rows.start[row + 1]; });
    std::partial_sum(rows.start.begin(), rows.start.end(), rows.start.begin());
    rows.items.resize(static_cast<std::size_t>(rows.start.back()));
    std::vector<int> next(rows.start.begin(), rows.start.end() - 1);
    each([&](int row, int item) { rows.items[next[row]++] = item; });
    return rows;
}

// The lowest node of the piece that contains this node; halves the path on the way.
int rootOf(std::vector<int>& parent, int node)
{
    while (parent[node] != node) node = parent[node] = parent[parent[node]];
    return node;
}

} // namespace

std::vector<std::array<int, 2>> edges(const TetMesh& mesh)
{
    std::vector<std::array<int, 2>> all;
    all.reserve(6 * mesh.tetrahedra.size());
    for (const Tetrahedron& t : mesh.tetrahedra)
        for (auto [i, j] : kTetrahedronEdges) all.push_back({std::min(t[i], t[j]), std::max(t[i], t[j])});
    sortUnique(all);
    return all;
}

CompressedRows nodeNeighbours(const TetMesh& mesh)
{
    const std::vector<std::array<int, 2>> all = edges(mesh);
    // Edges ascend by their lower node, then by their upper one. A node therefore gets its lower neighbours in
    // ascending order if the edges are visited first with the node as their upper end; the higher neighbours follow.
    return compress(mesh.nodes.size(), [&](auto&& visit) {
        for (auto [low, high] : all) visit(high, low);
        for (auto [low, high] : all) visit(low, high);
    });
}

CompressedRows tetrahedraAroundNodes(const TetMesh& mesh)
{
    return compress(mesh.nodes.size(), [&](auto&& visit) {
        for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t)
            for (int node : mesh.tetrahedra[t]) visit(node, t);
    });
}

std::vector<std::array<int, 4>> faceNeighbours(const TetMesh& mesh)
{
    std::vector<std::array<int, 4>> neighbours(mesh.tetrahedra.size(), {-1, -1, -1, -1});
    const std::vector<Face> faces = sortedFaces(mesh);
    for (std::size_t i = 1; i < faces.size(); ++i) {
        const Face &a = faces[i - 1], &b = faces[i];
        if (a.nodes != b.nodes) continue;
        FILASOFIA_ASSERT(neighbours[a.tetrahedron][a.side] == -1); // a third tetrahedron at one face
        neighbours[a.tetrahedron][a.side] = b.tetrahedron;
        neighbours[b.tetrahedron][b.side] = a.tetrahedron;
    }
    return neighbours;
}

Components connectedComponents(const TetMesh& mesh)
{
    std::vector<int> parent(mesh.nodes.size());
    std::iota(parent.begin(), parent.end(), 0);
    for (const Tetrahedron& t : mesh.tetrahedra)
        for (int i = 1; i < 4; ++i) {
            const int a = rootOf(parent, t[0]), b = rootOf(parent, t[i]);
            parent[std::max(a, b)] = std::min(a, b);
        }
    Components pieces;
    pieces.ofNode.assign(mesh.nodes.size(), -1);
    pieces.ofTetrahedron.reserve(mesh.tetrahedra.size());
    for (const Tetrahedron& t : mesh.tetrahedra) {
        int& piece = pieces.ofNode[rootOf(parent, t[0])];
        if (piece < 0) piece = pieces.count++;
        pieces.ofTetrahedron.push_back(piece);
    }
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (int node : mesh.tetrahedra[t]) pieces.ofNode[node] = pieces.ofTetrahedron[t];
    return pieces;
}

} // namespace filasofia::geometry
