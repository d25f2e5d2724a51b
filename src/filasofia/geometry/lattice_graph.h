#pragma once

#include "filasofia/core/disjoint_sets.h"
#include "filasofia/geometry/box.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

/// A body as coarseLattice() sees it: a graph, and its connected pieces.
namespace filasofia::geometry {

inline constexpr int kMinLatticeNodes = 16; ///< pieces with fewer nodes get no lattice of four coarse nodes
inline constexpr int kMaxListedPieces = 64; ///< small pieces that are listed one by one

/// Nodes and edges, and their connected pieces, the one with the most nodes first.
struct Graph {
    std::vector<Vec3> nodes;
    std::vector<std::array<int, 2>> edges;
    std::vector<int> original; ///< per node, its number in the body
    std::vector<int> piece;    ///< per node
    std::vector<int> pieceSize;
    std::vector<Box> box; ///< per piece
};

/// Fills in the pieces of a graph that has none yet.
void findPieces(Graph& graph);

/// The subgraph of the nodes for which taken(i) is true, and of the edges between them; its pieces are not yet found.
template <class Taken>
Graph subgraph(std::span<const Vec3> nodes, std::span<const std::array<int, 2>> edges, const Taken& taken)
{
    Graph graph;
    std::vector<int> renumbered(nodes.size(), -1);
    for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
        if (!taken(i)) continue;
        renumbered[i] = static_cast<int>(graph.nodes.size());
        graph.nodes.push_back(nodes[i]);
        graph.original.push_back(i);
    }
    for (auto [a, b] : edges)
        if (renumbered[a] >= 0 && renumbered[b] >= 0) graph.edges.push_back({renumbered[a], renumbered[b]});
    return graph;
}

/// The number of coarse nodes allowed, and how the pieces share them: the first `laid` pieces get a lattice, the first
/// `small` of the pieces with fewer than kMinLatticeNodes nodes are listed one by one, and the first `single` of the
/// others get one coarse node each.
struct Budget {
    int target = 0;
    int laid = 0;
    int large = 0; ///< pieces with kMinLatticeNodes nodes or more
    int small = 0;
    int single = 0;

    [[nodiscard]] bool isLaid(int piece) const { return piece < laid; }
    [[nodiscard]] bool isSmall(int piece) const { return piece >= large && piece < large + small; }
    [[nodiscard]] bool isSingle(int piece) const
    {
        const int before = piece < large ? laid : laid + small;
        return !isLaid(piece) && !isSmall(piece) && piece - before < single;
    }
};

Budget budgetOf(const Graph& graph, int target);

/// True if the pieces that get coarse nodes or are listed contain at least half of the nodes.
bool coversHalf(const Graph& graph, const Budget& budget);

} // namespace filasofia::geometry
