#include "filasofia/linalg/cluster_smoother.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/linalg/coarse_inverse.h"

#include <algorithm>

namespace filasofia::linalg {
namespace {

constexpr int kClustersPerPart = 16;

} // namespace

ClusterSmoother::ClusterSmoother(std::vector<int> nodes, std::span<const double> matrices) : nodes_(std::move(nodes))
{
    const std::size_t count = nodes_.size() / kPieceNodes;
    inverses_.assign(count * kPieceRows, {});
    constexpr std::size_t kNumbers = static_cast<std::size_t>(kPieceUnknowns) * kPieceUnknowns;
    for (std::size_t k = 0; k < count; ++k)
        if (!writePieceInverse(matrices.subspan(k * kNumbers, kNumbers),
                               std::span(inverses_).subspan(k * kPieceRows, kPieceRows)))
            std::fill_n(nodes_.begin() + static_cast<std::ptrdiff_t>(k * kPieceNodes), kPieceNodes, -1);
}

void ClusterSmoother::apply(const NodeArray& s, NodeArray& w, WorkerPool& pool) const
{
    const Parts parts{static_cast<int>(nodes_.size()) / kPieceNodes, kClustersPerPart};
    pool.run(parts.count(), [&](int part) {
        alignas(64) std::array<float, kPieceUnknowns> in{}, out{};
        for (int k = parts[part].begin; k < parts[part].end; ++k) {
            const auto nodes = std::span(nodes_).subspan(static_cast<std::size_t>(k) * kPieceNodes, kPieceNodes);
            for (std::size_t i = 0; i < nodes.size(); ++i)
                for (std::size_t c = 0; c < 3; ++c) in[3 * i + c] = nodes[i] < 0 ? 0.0f : s[nodes[i]][c];
            const std::size_t first = static_cast<std::size_t>(k) * kPieceRows;
            multiplyPanels(std::span(inverses_).subspan(first, kPieceRows), in, out, 0, kPiecePanels);
            for (std::size_t i = 0; i < nodes.size(); ++i)
                for (std::size_t c = 0; nodes[i] >= 0 && c < 3; ++c) w[nodes[i]][c] = out[3 * i + c];
        }
    });
}

} // namespace filasofia::linalg
