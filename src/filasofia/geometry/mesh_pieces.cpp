#include "filasofia/geometry/mesh_pieces.h"

#include "filasofia/core/disjoint_sets.h"
#include "filasofia/geometry/adjacency.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace filasofia::geometry {
namespace {

constexpr double kPlace = 1e-4; // times the shortest edge: far above the rounding of coordinates in single precision

int countOf(DisjointSets sets, int numbers)
{
    int count = 0;
    for (int i = 0; i < numbers; ++i) count += sets.find(i) == i ? 1 : 0;
    return count;
}

/// Cells of space, each known by a number that others may share.
struct Cells {
    double size = 0.0; ///< [m]

    [[nodiscard]] std::int64_t along(double x) const
    {
        constexpr double kShift = 0.5432109876; // so that the nodes of a lattice do not lie between cells
        return static_cast<std::int64_t>(std::floor(std::clamp(x / size + kShift, -9e18, 9e18)));
    }
    [[nodiscard]] static std::uint64_t number(std::int64_t i, std::int64_t j, std::int64_t k)
    {
        const auto mixed = [](std::uint64_t h, std::int64_t x) {
            h = (h ^ static_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15u;
            return h ^ h >> 29;
        };
        return mixed(mixed(mixed(0, i), j), k);
    }
};

/// Calls `visit` for each pair of nodes nearer than `within`, where cells are much larger. Pairs may come twice.
template <class Visit>
void forEachNear(const std::vector<Vec3>& nodes, const Cells& cells, double within, Visit&& visit)
{
    struct Entry {
        std::uint64_t cell;
        int node;
    };
    std::vector<Entry> entries;
    entries.reserve(nodes.size());
    for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
        const Vec3 p = nodes[i];
        entries.push_back({Cells::number(cells.along(p.x), cells.along(p.y), cells.along(p.z)), i});
    }
    std::ranges::sort(
        entries, [](const Entry& a, const Entry& b) { return a.cell != b.cell ? a.cell < b.cell : a.node < b.node; });
    const auto look = [&](auto entry, int i) {
        for (const std::uint64_t cell = entry->cell; entry != entries.end() && entry->cell == cell; ++entry)
            if (entry->node != i && distance(nodes[entry->node], nodes[i]) < within) visit(entry->node, i);
    };
    for (auto first = entries.begin(); first != entries.end();) {
        auto entry = first;
        for (; entry != entries.end() && entry->cell == first->cell; ++entry) {
            if (entry != first) look(first, entry->node);
            // The neighbouring cells, if the node is near their borders.
            const Vec3 p = nodes[entry->node];
            std::array<std::array<std::int64_t, 2>, 3> range{};
            for (int axis = 0; axis < 3; ++axis)
                range[axis] = {cells.along(p[axis] - within), cells.along(p[axis] + within)};
            if (range[0][0] == range[0][1] && range[1][0] == range[1][1] && range[2][0] == range[2][1]) continue;
            for (std::int64_t x = range[0][0]; x <= range[0][1]; ++x)
                for (std::int64_t y = range[1][0]; y <= range[1][1]; ++y)
                    for (std::int64_t z = range[2][0]; z <= range[2][1]; ++z) {
                        const std::uint64_t cell = Cells::number(x, y, z);
                        const auto found = std::ranges::lower_bound(entries, cell, {}, &Entry::cell);
                        if (cell != first->cell && found != entries.end() && found->cell == cell)
                            look(found, entry->node);
                    }
        }
        first = entry;
    }
}

double shortestEdge(const TetMesh& mesh)
{
    double least = std::numeric_limits<double>::infinity();
    for (const Tetrahedron& t : mesh.tetrahedra)
        for (const auto [i, j] : kTetrahedronEdges)
            least = std::min(least, lengthSquared(mesh.nodes[t[i]] - mesh.nodes[t[j]]));
    return std::sqrt(least);
}

/// The places of a mesh: sets of nodes that lie on each other.
DisjointSets placesOf(const TetMesh& mesh)
{
    DisjointSets places(mesh.nodes.size());
    const double within = placeDistance(mesh);
    if (!(within > 0.0 && std::isfinite(within))) return places;
    forEachNear(mesh.nodes, Cells{0.5 * within / kPlace}, within, [&](int i, int j) { places.join(i, j); });
    return places;
}

} // namespace

double placeDistance(const TetMesh& mesh) { return kPlace * shortestEdge(mesh); }

MeshPieces piecesOf(const TetMesh& mesh)
{
    DisjointSets pieces(mesh.nodes.size());
    for (const Tetrahedron& t : mesh.tetrahedra)
        for (int k = 1; k < 4; ++k) pieces.join(t[0], t[k]);
    const auto nodes = static_cast<int>(mesh.nodes.size());
    return {.pieces = countOf(pieces, nodes), .doubled = nodes - countOf(placesOf(mesh), nodes)};
}

TetMesh withJoinedNodes(const TetMesh& mesh, std::string_view name)
{
    DisjointSets places = placesOf(mesh);
    TetMesh joined{.nodes = {}, .tetrahedra = mesh.tetrahedra, .labels = mesh.labels, .labelNames = mesh.labelNames};
    std::vector<int> numbers(mesh.nodes.size());
    for (int i = 0; i < static_cast<int>(numbers.size()); ++i) {
        const int first = places.find(i);
        if (first == i) joined.nodes.push_back(mesh.nodes[i]);
        numbers[i] = first == i ? static_cast<int>(joined.nodes.size()) - 1 : numbers[first];
    }
    for (Tetrahedron& t : joined.tetrahedra)
        for (int& node : t) node = numbers[node];
    check(joined, name);
    return joined;
}

TetMesh withSplitNodes(const TetMesh& mesh)
{
    // Corners of tetrahedra, four of each, are one if a face joins them.
    const std::vector<std::array<int, 4>> neighbours = faceNeighbours(mesh);
    DisjointSets corners(4 * mesh.tetrahedra.size());
    for (int t = 0; t < static_cast<int>(mesh.tetrahedra.size()); ++t)
        for (int face = 0; face < 4; ++face) {
            const int other = neighbours[t][face];
            if (other < t) continue; // none, or seen from there
            const Tetrahedron& there = mesh.tetrahedra[other];
            for (int k = 0; k < 4; ++k) {
                const auto found = std::ranges::find(there, mesh.tetrahedra[t][k]);
                if (found != there.end()) corners.join(4 * t + k, 4 * other + static_cast<int>(found - there.begin()));
            }
        }
    TetMesh out = mesh;
    std::vector<bool> taken(mesh.nodes.size());
    std::vector<int> nodeOf(4 * mesh.tetrahedra.size(), -1); // by the corner that represents a set
    for (int i = 0; i < static_cast<int>(nodeOf.size()); ++i) {
        int& node = nodeOf[corners.find(i)];
        int& corner = out.tetrahedra[i / 4][i % 4];
        if (node < 0) {
            node = corner;
            if (taken[corner]) {
                node = static_cast<int>(out.nodes.size());
                out.nodes.push_back(mesh.nodes[corner]);
            }
            taken[corner] = true;
        }
        corner = node;
    }
    return out;
}

} // namespace filasofia::geometry
