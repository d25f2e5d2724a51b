#include "filasofia/engine/soft/node_clusters.h"

#include "filasofia/core/sorted.h"
#include "filasofia/linalg/small_pieces.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace filasofia::engine {

std::vector<std::vector<int>> nodeClusters(std::span<const Vec3> rest, std::span<const std::array<int, 2>> edges,
                                           const std::vector<bool>& active)
{
    struct Edge {
        double squared = 0.0; ///< [m^2] length
        int low = 0, high = 0;
        auto operator<=>(const Edge&) const = default;
    };
    std::vector<Edge> list;
    list.reserve(edges.size());
    for (const auto& [a, b] : edges) {
        const auto low = static_cast<std::size_t>(std::min(a, b)), high = static_cast<std::size_t>(std::max(a, b));
        if (low != high && active[low] && active[high])
            list.push_back({lengthSquared(rest[low] - rest[high]), std::min(a, b), std::max(a, b)});
    }
    sortUnique(list);

    std::vector<std::size_t> clusterOf(rest.size());
    std::iota(clusterOf.begin(), clusterOf.end(), std::size_t{0});
    std::vector<std::vector<int>> clusters(rest.size());
    for (std::size_t i = 0; i < rest.size(); ++i) clusters[i] = {static_cast<int>(i)};
    for (const Edge& each : list) {
        std::size_t one = clusterOf[static_cast<std::size_t>(each.low)];
        std::size_t two = clusterOf[static_cast<std::size_t>(each.high)];
        if (clusters[one].size() < clusters[two].size()) std::swap(one, two);
        if (one == two || clusters[one].size() + clusters[two].size() > linalg::kPieceNodes) continue;
        for (int node : clusters[two]) clusterOf[static_cast<std::size_t>(node)] = one;
        clusters[one].insert(clusters[one].end(), clusters[two].begin(), clusters[two].end());
        clusters[two].clear();
    }
    std::erase_if(clusters, [](const std::vector<int>& each) { return each.size() < 2; });
    return clusters;
}

} // namespace filasofia::engine
