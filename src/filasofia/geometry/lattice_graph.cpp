#include "filasofia/geometry/lattice_graph.h"

namespace filasofia::geometry {

void findPieces(Graph& graph)
{
    const int n = static_cast<int>(graph.nodes.size());
    DisjointSets sets(graph.nodes.size());
    for (auto [a, b] : graph.edges) sets.join(a, b);
    std::vector<int> size(graph.nodes.size(), 0), rank(graph.nodes.size(), 0), roots;
    for (int i = 0; i < n; ++i) {
        if (sets.find(i) == i) roots.push_back(i);
        ++size[sets.find(i)];
    }
    std::ranges::stable_sort(roots, [&](int a, int b) { return size[a] > size[b]; });
    for (int root : roots) {
        rank[root] = static_cast<int>(graph.pieceSize.size());
        graph.pieceSize.push_back(size[root]);
    }
    graph.box.resize(roots.size());
    for (int i = 0; i < n; ++i) {
        graph.piece.push_back(rank[sets.find(i)]);
        graph.box[graph.piece[i]] = merged(graph.box[graph.piece[i]], graph.nodes[i]);
    }
}

Budget budgetOf(const Graph& graph, int target)
{
    Budget budget{std::min(target, static_cast<int>(graph.nodes.size()) / 4)};
    const int pieces = static_cast<int>(graph.pieceSize.size());
    const auto large = std::ranges::partition_point(graph.pieceSize, [](int size) { return size >= kMinLatticeNodes; });
    budget.large = static_cast<int>(large - graph.pieceSize.begin());
    budget.laid = budget.large;
    // A lattice takes at least four coarse nodes; together with the pieces of a single coarse node this leaves a
    // quarter of the target for finer cells.
    if (4 * budget.laid > budget.target) budget.laid = std::max(1, budget.target / 8);
    budget.small = std::min(pieces - budget.large, kMaxListedPieces);
    const int forSingle = budget.laid == 0 ? budget.target : budget.target / 4;
    budget.single = std::min(pieces - budget.laid - budget.small, forSingle);
    return budget;
}

bool coversHalf(const Graph& graph, const Budget& budget)
{
    int covered = 0;
    for (int piece = 0; piece < static_cast<int>(graph.pieceSize.size()); ++piece)
        if (budget.isLaid(piece) || budget.isSmall(piece) || budget.isSingle(piece)) covered += graph.pieceSize[piece];
    return 2 * covered >= static_cast<int>(graph.nodes.size());
}

} // namespace filasofia::geometry
