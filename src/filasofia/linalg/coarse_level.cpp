#include "filasofia/linalg/coarse_level.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/linalg/coarse_inverse.h"

#include <algorithm>

namespace filasofia::linalg {
namespace {

constexpr Parts panelParts(int panels) { return {panels, 4}; }

} // namespace

CoarseLevel::CoarseLevel(const PreconditionerInput& in, int blocks)
{
    if (in.coarseNodes == 0 && in.freePieces.empty()) return;
    if (auto inverse = coarseInverse(in))
        build(std::move(*inverse), {{}, {}, in.freePieces, in.coarseNodes, in.rows, in.corners, in.weights}, blocks);
}

CoarseLevel::CoarseLevel(const CoarseInput& in)
{
    if (auto inverse = coarseInverse(in)) build(std::move(*inverse), in, blocksFor(static_cast<int>(in.rows.size())));
}

void CoarseLevel::build(CoarseInverse&& inverse, const CoarseInput& in, int blocks)
{
    const int pieces = static_cast<int>(inverse.pieces.size() / kPieceRows);
    latticeNodes_ = in.coarseNodes;
    coarseNodes_ = pieces == 0 ? latticeNodes_ : firstPieceNode(latticeNodes_) + pieces * kPieceNodes;
    residual_.assign(static_cast<std::size_t>(coarseRows(coarseNodes_)), 0.0f);
    correction_.assign(static_cast<std::size_t>(blocksFor(3 * coarseNodes_) * kBlock + 4), 0.0f);
    inverse_ = std::move(inverse.lattice);
    pieces_ = SmallPieces(std::move(inverse.pieces), in.freePieces, latticeNodes_);
    interpolation_ = CoarseInterpolation(in, blocks, coarseNodes_);
}

void CoarseLevel::resize(int blocks)
{
    if (coarseNodes_ > 0) interpolation_.resize(blocks);
}

Interpolation CoarseLevel::interpolation(int node) const
{
    return coarseNodes_ > 0 ? interpolation_.at(node) : Interpolation{};
}

void CoarseLevel::interpolate(int node, const Interpolation& interpolation)
{
    if (coarseNodes_ > 0) interpolation_.set(node, interpolation);
}

void CoarseLevel::restrictResidual(const NodeArray& s, WorkerPool& pool)
{
    interpolation_.restrictTo(residual_, s, pool);
}

void CoarseLevel::solve(WorkerPool& pool)
{
    if (aside_) {
        std::ranges::fill(correction_, 0.0f);
        return;
    }
    const Parts panels = panelParts(blocksFor(3 * latticeNodes_));
    const auto rows = std::span<const float>(residual_).first(static_cast<std::size_t>(coarseRows(latticeNodes_)));
    pool.run(panels.count(),
             [&](int part) { multiplyPanels(inverse_, rows, correction_, panels[part].begin, panels[part].end); });
    pieces_.solve(residual_, correction_);
}

double CoarseLevel::inverseEntry(std::size_t row, std::size_t column) const
{
    const auto rows = static_cast<std::size_t>(coarseRows(latticeNodes_));
    return static_cast<double>(inverse_[row / kBlock * rows + column].values[row % kBlock]);
}

void CoarseLevel::solve(std::span<const float> residuals, std::span<float> corrections, std::size_t count) const
{
    if (aside_) {
        std::ranges::fill(corrections, 0.0f);
        return;
    }
    const std::size_t rows = residual_.size(), entries = correction_.size();
    const auto onLattice = [&](std::size_t vector) {
        return std::ranges::any_of(residuals.subspan(vector * rows, 3 * static_cast<std::size_t>(latticeNodes_)),
                                   [](float each) { return each != 0.0f; });
    };
    // Runs of vectors that reach the lattice go together; for those at small pieces alone its correction is zero.
    for (std::size_t v = 0, end = 0; v < count; v = end + 1) {
        for (end = v; end < count && onLattice(end);) ++end;
        multiplyPanels(inverse_, residuals.subspan(v * rows), corrections.subspan(v * entries),
                       {.count = static_cast<int>(end - v),
                        .rows = coarseRows(latticeNodes_),
                        .stride = static_cast<int>(rows),
                        .resultStride = static_cast<int>(entries)},
                       blocksFor(3 * latticeNodes_));
    }
    for (std::size_t v = 0; v < count; ++v)
        pieces_.solve(residuals.subspan(v * rows, rows), corrections.subspan(v * entries, entries));
}

} // namespace filasofia::linalg
