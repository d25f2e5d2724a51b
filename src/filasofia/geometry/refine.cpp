#include "filasofia/geometry/refine.h"

#include "filasofia/geometry/adjacency.h"

#include <algorithm>

namespace filasofia::geometry {
namespace {

using Edges = std::vector<std::array<int, 2>>;

// The four corners and, in the order of kTetrahedronEdges, the midpoints of the edges.
using Corners = std::array<int, 10>;
constexpr int k01 = 4, k02 = 5, k03 = 6, k12 = 7, k13 = 8, k23 = 9;

constexpr std::array<Tetrahedron, 4> kCornerTetrahedra{
    {{0, k01, k02, k03}, {k01, 1, k12, k13}, {k02, k12, 2, k23}, {k03, k13, k23, 3}}};

/// A diagonal of the inner octahedron, and its other four corners, which turn right-handed around it.
struct Diagonal {
    std::array<int, 2> ends;
    std::array<int, 4> ring;
};
// Each line is the previous one with the corners 1, 2, 3 renamed 2, 3, 1, which keeps volumes positive.
constexpr std::array<Diagonal, 3> kDiagonals{
    {{{k01, k23}, {k02, k03, k13, k12}}, {{k02, k13}, {k03, k01, k12, k23}}, {{k03, k12}, {k01, k02, k23, k13}}}};

Corners cornersOf(const Tetrahedron& t, const Edges& all, int firstMiddle)
{
    Corners corners{t[0], t[1], t[2], t[3]};
    for (std::size_t e = 0; e < kTetrahedronEdges.size(); ++e) {
        const auto [i, j] = kTetrahedronEdges[e];
        const std::array edge{std::min(t[i], t[j]), std::max(t[i], t[j])};
        corners[4 + e] = firstMiddle + static_cast<int>(std::ranges::lower_bound(all, edge) - all.begin());
    }
    return corners;
}

const Diagonal& shortestDiagonal(const std::vector<Vec3>& nodes, const Corners& corners)
{
    const auto size = [&](const Diagonal& d) {
        return lengthSquared(nodes[corners[d.ends[0]]] - nodes[corners[d.ends[1]]]);
    };
    return *std::ranges::min_element(kDiagonals, {}, size);
}

} // namespace

TetMesh refined(const TetMesh& mesh)
{
    const Edges all = edges(mesh);
    TetMesh fine{.nodes = mesh.nodes, .tetrahedra = {}, .labels = {}, .labelNames = mesh.labelNames};
    for (int label : mesh.labels) fine.labels.insert(fine.labels.end(), 8, label);
    for (auto [a, b] : all) fine.nodes.push_back(0.5 * mesh.nodes[a] + 0.5 * mesh.nodes[b]);

    fine.tetrahedra.reserve(8 * mesh.tetrahedra.size());
    for (const Tetrahedron& t : mesh.tetrahedra) {
        const Corners at = cornersOf(t, all, static_cast<int>(mesh.nodes.size()));
        for (auto [a, b, c, d] : kCornerTetrahedra) fine.tetrahedra.push_back({at[a], at[b], at[c], at[d]});
        const auto& [ends, ring] = shortestDiagonal(fine.nodes, at);
        for (std::size_t k = 0; k < 4; ++k)
            fine.tetrahedra.push_back({at[ends[0]], at[ends[1]], at[ring[k]], at[ring[(k + 1) % 4]]});
    }
    return fine;
}

} // namespace filasofia::geometry
