#include "filasofia/linalg/block_jacobi.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/linalg/node_parts.h"

namespace filasofia::linalg {

void BlockJacobi::set(int node, const Mat3& block)
{
    auto& m = inverse_[static_cast<std::size_t>(node / kBlock)].m;
    const Mat3 value = filasofia::inverse(block);
    const double entries[6] = {value[0].x, value[0].y, value[0].z, value[1].y, value[1].z, value[2].z};
    for (int k = 0; k < 6; ++k) m[k][node % kBlock] = static_cast<float>(entries[k]);
}

void BlockJacobi::set(const DiagonalTerms& terms, const std::vector<RotationBlock>& rotations, WorkerPool& pool)
{
    const Parts nodes = nodeParts(blocks());
    pool.run(nodes.count(), [&](int part) { invertDiagonal(terms, rotations, inverse_, nodes[part]); });
}

Mat3 BlockJacobi::inverse(int node) const
{
    const auto& m = inverse_[static_cast<std::size_t>(node / kBlock)].m;
    const auto at = [&](int k) { return static_cast<double>(m[k][node % kBlock]); };
    return {{{at(0), at(1), at(2)}, {at(1), at(3), at(4)}, {at(2), at(4), at(5)}}};
}

void BlockJacobi::apply(const std::vector<RotationBlock>& rotations, const NodeArray& r, NodeArray& s, NodeArray& w,
                        WorkerPool& pool) const
{
    const Parts nodes = nodeParts(r.blocks());
    pool.run(nodes.count(), [&](int part) { warpAndSmooth(rotations, inverse_, r, s, w, nodes[part]); });
}

} // namespace filasofia::linalg
