#pragma once

#include "filasofia/geometry/box.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <vector>

/// What coarseLattice() sees of a body: a graph, and the pieces it falls into.
namespace filasofia::geometry {

inline constexpr int kFewest = 16;     ///< nodes that are worth four coarse ones
inline constexpr int kMostPieces = 64; ///< with fewer nodes, that are told one by one

/// Numbers joined into sets. The lowest number of a set stands for it, in whatever order they were joined.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
    int find(int i)
    {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(int a, int b)
    {
        a = find(a), b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<int> parent_;
};

/// Nodes and edges, and the pieces they fall into, the one with the most nodes first.
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

/// The nodes for which `taken` holds and the edges between them, their pieces not yet found.
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

/// How many coarse nodes there may be and how the pieces share them: the first `laid` get a lattice, of those with
/// fewer than kFewest nodes the first `small` are told one by one, and of the others the first `single` get one coarse
/// node each.
struct Budget {
    int target = 0;
    int laid = 0;
    int large = 0; ///< pieces with kFewest nodes or more
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

/// Whether the pieces that get coarse nodes or are told hold half of the nodes.
bool coversHalf(const Graph& graph, const Budget& budget);

} // namespace filasofia::geometry
