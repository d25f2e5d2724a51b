#include "filasofia/linalg/coarse_interpolation.h"

#include "filasofia/core/worker_pool.h"

namespace filasofia::linalg {
namespace {

constexpr Parts coarseNodeParts(int nodes) { return {nodes, 16}; }

} // namespace

CoarseInterpolation::CoarseInterpolation(const CoarseInput& in, int blocks, int coarseNodes)
    : blocks_(static_cast<std::size_t>(blocks))
{
    std::vector<std::vector<RestrictionEntry>> entries(static_cast<std::size_t>(coarseNodes));
    for (std::size_t i = 0; i < in.rows.size(); ++i)
        for (std::size_t k = 0; k < 4; ++k) {
            const int corner = in.corners[in.rows[i]][k];
            const float weight = in.weights[in.rows[i]][k];
            blocks_[i / kBlock].at[i % kBlock][k] = 3 * corner;
            blocks_[i / kBlock].weights[i % kBlock][k] = weight;
            if (weight != 0.0f) entries[corner].push_back({static_cast<int>(i), weight});
        }
    restriction_ = Restriction(entries);
}

Interpolation CoarseInterpolation::at(int node) const
{
    Interpolation interpolation;
    const InterpolationBlock& block = blocks_[static_cast<std::size_t>(node / kBlock)];
    for (std::size_t k = 0; k < 4; ++k) {
        interpolation.corners[k] = block.at[node % kBlock][k] / 3;
        interpolation.weights[k] = block.weights[node % kBlock][k];
    }
    return interpolation;
}

void CoarseInterpolation::set(int node, const Interpolation& interpolation)
{
    InterpolationBlock& block = blocks_[static_cast<std::size_t>(node / kBlock)];
    for (std::size_t k = 0; k < 4; ++k) {
        const auto before = static_cast<std::size_t>(block.at[node % kBlock][k] / 3);
        if (const float weight = block.weights[node % kBlock][k]; weight != 0.0f)
            restriction_.remove(before, {node, weight});
        block.at[node % kBlock][k] = 3 * interpolation.corners[k];
        block.weights[node % kBlock][k] = interpolation.weights[k];
        if (interpolation.weights[k] != 0.0f)
            restriction_.add(static_cast<std::size_t>(interpolation.corners[k]), {node, interpolation.weights[k]});
    }
}

void CoarseInterpolation::restrictTo(std::span<float> coarse, const NodeArray& s, WorkerPool& pool) const
{
    const Parts parts = coarseNodeParts(static_cast<int>(restriction_.ranges.size()));
    pool.run(parts.count(),
             [&](int part) { linalg::restrictTo(restriction_, s, coarse, parts[part].begin, parts[part].end); });
}

void CoarseInterpolation::addRestricted(int node, Vec3 value, std::span<float> coarse) const
{
    const InterpolationBlock& block = blocks_[static_cast<std::size_t>(node / kBlock)];
    for (int k = 0; k < 4; ++k)
        for (int i = 0; i < 3; ++i)
            coarse[static_cast<std::size_t>(block.at[node % kBlock][k] + i)] +=
                block.weights[node % kBlock][k] * static_cast<float>(value[i]);
}

std::vector<float> CoarseInterpolation::restrictNumbers(std::span<const float> m) const
{
    std::vector<float> sums(restriction_.ranges.size());
    for (std::size_t c = 0; c < sums.size(); ++c)
        for (const RestrictionEntry* each = restriction_.begin(c); each != restriction_.end(c); ++each)
            sums[c] += each->weight * m[static_cast<std::size_t>(each->node)];
    return sums;
}

int CoarseInterpolation::firstNode(std::size_t coarse) const
{
    return restriction_.size(coarse) == 0 ? -1 : restriction_.begin(coarse)->node;
}

} // namespace filasofia::linalg
