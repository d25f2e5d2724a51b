#include "filasofia/linalg/two_level_preconditioner.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/linalg/node_parts.h"
#include "filasofia/math/polar.h"

#include <algorithm>
#include <cmath>

namespace filasofia::linalg {
namespace {

// [-] Coherence below which rotations are blended.
constexpr double kBlendBelow = 0.995;

} // namespace

TwoLevelPreconditioner::TwoLevelPreconditioner(const PreconditionerInput& in)
{
    grow(std::max(in.blocks, blocksFor(static_cast<int>(in.rows.size()))));
    for (std::size_t i = 0; i < in.rows.size(); ++i)
        setDiagonal(static_cast<int>(i), in.scale * in.matrix.block(in.matrix.find(in.rows[i], in.rows[i])));
    coarse_ = CoarseLevel(in, smoother_.blocks());
}

void TwoLevelPreconditioner::grow(int blocks)
{
    RotationBlock identity{};
    for (int k : {0, 4, 8}) std::fill(std::begin(identity.m[k]), std::end(identity.m[k]), 1.0f);
    rotations_.resize(static_cast<std::size_t>(blocks), identity);
    smoother_.grow(blocks);
    present_.grow(blocks);
    coarse_.resize(blocks);
    rest_ = NodeArray(blocks);
    smoothed_ = NodeArray(blocks);
    blended_ = false;
    sums_.resize(static_cast<std::size_t>(nodeParts(blocks).count()));
}

void TwoLevelPreconditioner::setDiagonal(int node, const Mat3& block)
{
    smoother_.set(node, block);
    coarseMasses_.clear(); // the node's mass may have changed as well
}

void TwoLevelPreconditioner::interpolate(int node, const Interpolation& how)
{
    coarse_.interpolate(node, how);
    coarseMasses_.clear();
}

bool TwoLevelPreconditioner::takeCoarseLevel(CoarseLevel&& from)
{
    if (from.coarseNodes() == 0) return false;
    const bool aside = coarse_.isAside();
    coarse_ = std::move(from);
    coarse_.setAside(aside);
    coarse_.resize(smoother_.blocks());
    coarseMasses_.clear();
    return true;
}

void TwoLevelPreconditioner::followPieces(const NodeArray& x, std::span<const float> masses, double massWeight)
{
    coarse_.followPieces({rotations_, x, masses, massWeight});
}

void TwoLevelPreconditioner::sumRotations()
{
    turned_.assign(static_cast<std::size_t>(coarse_.coarseNodes()), {});
    weights_.assign(turned_.size(), 0.0);
    for (int node = 0; node < kBlock * smoother_.blocks(); ++node) {
        const Interpolation how = coarse_.interpolation(node);
        const Mat3 turn = rotation(node);
        for (std::size_t k = 0; k < how.corners.size(); ++k) {
            if (how.weights[k] == 0.0f) continue;
            turned_[static_cast<std::size_t>(how.corners[k])] += static_cast<double>(how.weights[k]) * turn;
            weights_[static_cast<std::size_t>(how.corners[k])] += how.weights[k];
        }
    }
}

double TwoLevelPreconditioner::coherenceAt(std::size_t coarseNode) const
{
    const Mat3& sum = turned_[coarseNode];
    const double size = std::sqrt((lengthSquared(sum[0]) + lengthSquared(sum[1]) + lengthSquared(sum[2])) / 3.0);
    return weights_[coarseNode] > 0.0 ? size / weights_[coarseNode] : 1.0;
}

double TwoLevelPreconditioner::coherence()
{
    sumRotations();
    double least = 1.0;
    for (std::size_t c = 0; c < turned_.size(); ++c) least = std::min(least, coherenceAt(c));
    return least;
}

bool TwoLevelPreconditioner::blendRotations()
{
    if (coarse_.isAside() || blended_) return false;
    sumRotations();
    std::vector<char> turned(turned_.size()); // the motions of small pieces hold R already
    for (std::size_t c = 0; c < static_cast<std::size_t>(coarse_.latticeNodes()); ++c)
        turned[c] = coherenceAt(c) < kBlendBelow ? 1 : 0;
    if (std::ranges::find(turned, 1) == turned.end()) return false;
    blend_ = rotations_;
    RotationBlock identity{};
    for (int k : {0, 4, 8}) std::ranges::fill(identity.m[k], 1.0f);
    toBlend_.assign(rotations_.size(), identity);
    for (int node = 0; node < kBlock * smoother_.blocks(); ++node) {
        const Interpolation how = coarse_.interpolation(node);
        Mat3 sum;
        bool touched = false;
        for (std::size_t k = 0; k < how.corners.size(); ++k) {
            if (how.weights[k] == 0.0f) continue;
            const auto corner = static_cast<std::size_t>(how.corners[k]);
            sum += static_cast<double>(how.weights[k]) / weights_[corner] * turned_[corner];
            touched = touched || turned[corner] != 0;
        }
        if (!touched) continue;
        const Mat3 mean = toMat3(polarRotation(sum, {}));
        storeRotation(blend_, node, mean);
        storeRotation(toBlend_, node, transpose(mean) * rotation(node));
    }
    blended_ = true;
    return true;
}

void TwoLevelPreconditioner::turnToBlend(WorkerPool& pool)
{
    if (!blended_) return;
    const Parts parts = nodeParts(rest_.blocks());
    pool.run(parts.count(), [&](int part) { turnBoth(toBlend_, rest_, smoothed_, parts[part]); });
}

void TwoLevelPreconditioner::usePresent(std::span<const Mat3> diagonal)
{
    presentUsed_ = !diagonal.empty();
    coarse_.setAside(presentUsed_);
    for (std::size_t i = 0; i < diagonal.size(); ++i) {
        const Mat3 turn = rotation(static_cast<int>(i));
        present_.set(static_cast<int>(i), transpose(turn) * diagonal[i] * turn);
    }
}

void TwoLevelPreconditioner::usePresentSmoother(const DiagonalTerms& diagonal, WorkerPool& pool)
{
    presentUsed_ = true;
    present_.set(diagonal, rotations_, pool);
}

double TwoLevelPreconditioner::apply(const NodeArray& r, NodeArray& z, WorkerPool& pool)
{
    smoother().apply(rotations_, r, rest_, smoothed_, pool);
    if (!presentUsed_) clusters_.apply(rest_, smoothed_, pool);
    turnToBlend(pool);
    restricted_ = false;
    return applyCoarse(r, z, pool);
}

void TwoLevelPreconditioner::smooth(const NodeArray& r, WorkerPool& pool)
{
    smoother().apply(rotations_, r, rest_, smoothed_, pool);
    turnToBlend(pool);
    restricted_ = false;
}

void TwoLevelPreconditioner::restrictOnce(WorkerPool& pool)
{
    if (!restricted_) coarse_.restrictResidual(rest_, pool);
    restricted_ = true;
}

std::span<const float> TwoLevelPreconditioner::coarseAnswer(WorkerPool& pool)
{
    restrictOnce(pool);
    coarse_.solve(pool);
    return coarse_.correction();
}

void TwoLevelPreconditioner::subtractFromCoarse(std::span<const int> coarseNodes, std::span<const float> values,
                                                float factor)
{
    const std::span<float> residual = coarse_.residual();
    for (std::size_t i = 0; i < coarseNodes.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k)
            residual[3 * static_cast<std::size_t>(coarseNodes[i]) + k] -= factor * values[3 * i + k];
}

double TwoLevelPreconditioner::applyCoarse(const NodeArray& r, NodeArray& z, WorkerPool& pool,
                                           std::span<const double> coefficients)
{
    if (coarse_.coarseNodes() > 0) {
        restrictOnce(pool);
        coarse_.solve(pool);
        deflation_.subtract(coefficients, coarse_.correction());
    }
    return sumOfParts(pool, nodeParts(r.blocks()), sums_, [&](Blocks blocks) {
        return prolongAndUnwarp(coarseRotations(), {coarse_.interpolation().blocks(), coarse_.correction()}, smoothed_,
                                r, z, blocks);
    });
}

void TwoLevelPreconditioner::carry(std::span<const float> masses, const NodeArray& r, NodeArray& carried,
                                   WorkerPool& pool)
{
    if (coarseMasses_.empty()) coarseMasses_ = coarse_.interpolation().restrictNumbers(masses);
    coarse_.restrictResidual(r, pool);
    const std::span<float> velocities = coarse_.correction();
    for (std::size_t c = 0; c < coarseMasses_.size(); ++c)
        for (std::size_t k = 3 * c; k < 3 * c + 3; ++k)
            velocities[k] = coarseMasses_[c] > 0.0f ? coarse_.residual()[k] / coarseMasses_[c] : 0.0f;
    const Parts parts = nodeParts(r.blocks());
    pool.run(parts.count(), [&](int part) {
        prolongByMass({coarse_.interpolation().blocks(), velocities}, masses, carried, parts[part]);
    });
}

void TwoLevelPreconditioner::addToCoarseResidual(int node, Vec3 change)
{
    const Vec3 rest = transposeTimes(coarseRotation(node), change);
    float* s = rest_[node];
    for (int k = 0; k < 3; ++k) s[k] += static_cast<float>(rest[k]);
}

Mat3 TwoLevelPreconditioner::inverseDiagonal(int node) const
{
    return rotation(node) * smoother().inverse(node) * transpose(rotation(node));
}

void TwoLevelPreconditioner::addColumn(std::span<const ColumnEntry> column)
{
    const std::span<float> values = deflation_.addColumn(coarse_.residual().size());
    for (const ColumnEntry& each : column) {
        const Vec3 rest = transposeTimes(coarseRotation(each.node), each.value);
        coarse_.interpolation().addRestricted(each.node, rest, values);
    }
}

void TwoLevelPreconditioner::project(std::span<double> out, WorkerPool& pool)
{
    restrictOnce(pool);
    deflation_.project(coarse_.residual(), out);
}

} // namespace filasofia::linalg
