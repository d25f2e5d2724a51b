#include "filasofia/linalg/two_level_preconditioner.h"

#include "filasofia/core/worker_pool.h"
#include "filasofia/linalg/eigen_blocking.h"
#include "filasofia/linalg/node_parts.h"

#include <Eigen/Cholesky>

#include <algorithm>

namespace filasofia::linalg {
namespace {

// Coarse nodes that hold hardly anything of the body make A_c nearly singular. What this adds to its diagonal, relative
// to the diagonal, does not slow the iteration, and float can invert what is left.
constexpr double kShift = 1e-5;

constexpr Parts coarseNodeParts(int nodes) { return {nodes, 16}; }
constexpr Parts panelParts(int panels) { return {panels, 4}; }
constexpr int fours(int count) { return (count + 3) / 4 * 4; }

void setBlock(std::vector<SymmetricBlock>& blocks, int node, const Mat3& value)
{
    auto& m = blocks[static_cast<std::size_t>(node / kBlock)].m;
    const double entries[6] = {value[0].x, value[0].y, value[0].z, value[1].y, value[1].z, value[2].z};
    for (int k = 0; k < 6; ++k) m[k][node % kBlock] = static_cast<float>(entries[k]);
}

struct CoarseMatrix {
    Eigen::MatrixXd lattice;
    std::vector<Eigen::MatrixXd> pieces;
};

/// P^T A P, without forming P: every block of A goes to the four times four coarse nodes of its row and column. Nothing
/// couples a small piece with anything else.
CoarseMatrix galerkin(const PreconditionerInput& in)
{
    std::vector<bool> unknown(static_cast<std::size_t>(in.matrix.rows()));
    for (int row : in.rows) unknown[row] = true;
    CoarseMatrix coarse{Eigen::MatrixXd::Zero(3 * in.coarseNodes, 3 * in.coarseNodes),
                        {in.freePieces.size(), Eigen::MatrixXd::Zero(kPieceUnknowns, kPieceUnknowns)}};
    const int firstPiece = firstPieceNode(in.coarseNodes);
    const auto blockAt = [&](int row, int column) {
        if (row < in.coarseNodes) return coarse.lattice.block<3, 3>(3 * row, 3 * column);
        const int piece = (row - firstPiece) / kPieceNodes, first = firstPiece + piece * kPieceNodes;
        return coarse.pieces[static_cast<std::size_t>(piece)].block<3, 3>(3 * (row - first), 3 * (column - first));
    };
    for (int row : in.rows)
        for (int at = in.matrix.rowStarts()[row]; at < in.matrix.rowStarts()[row + 1]; ++at) {
            const int column = in.matrix.columns()[at];
            if (!unknown[column]) continue;
            const Mat3& m = in.matrix.block(at);
            const Eigen::Matrix3d block{{m[0].x, m[0].y, m[0].z}, {m[1].x, m[1].y, m[1].z}, {m[2].x, m[2].y, m[2].z}};
            for (std::size_t a = 0; a < 4; ++a)
                for (std::size_t b = 0; b < 4; ++b) {
                    const double weight = static_cast<double>(in.weights[row][a]) * in.weights[column][b];
                    if (weight == 0.0) continue;
                    blockAt(in.corners[row][a], in.corners[column][b]) += weight * in.scale * block;
                }
        }
    return coarse;
}

/// Of a positive definite matrix whose lower half is given, made a little larger so that it is well conditioned.
Eigen::LLT<Eigen::MatrixXd> factorOf(Eigen::MatrixXd coarse)
{
    fixBlocking();
    const double largest = coarse.diagonal().maxCoeff();
    for (Eigen::Index i = 0; i < coarse.rows(); ++i) coarse(i, i) += kShift * coarse(i, i) + 1e-12 * largest;
    return Eigen::LLT<Eigen::MatrixXd>(coarse);
}

/// Empty where the matrix is not positive definite to rounding: the smoother alone will do.
Eigen::MatrixXd inverseOf(Eigen::MatrixXd coarse)
{
    const Eigen::LLT<Eigen::MatrixXd> factor = factorOf(std::move(coarse));
    if (factor.info() != Eigen::Success) return {};
    Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(factor.rows(), factor.cols()));
    return inverse.allFinite() ? inverse : Eigen::MatrixXd();
}

/// The same in less than half of the operations, leaving out zeros: A^-1 = L^-T L^-1, in blocks of columns. Not the
/// same to the last bit, and the motion of every body that was never cut hangs on those of the other.
Eigen::MatrixXd quickInverseOf(Eigen::MatrixXd coarse)
{
    constexpr Eigen::Index kColumns = 48;
    const Eigen::LLT<Eigen::MatrixXd> factor = factorOf(std::move(coarse));
    if (factor.info() != Eigen::Success) return {};
    const Eigen::Index n = factor.rows();
    Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(n, n), inverse(n, n); // L^-1
    for (Eigen::Index j = 0; j < n; j += kColumns) {
        const Eigen::Index left = n - j, columns = std::min(kColumns, left);
        lower.block(j, j, left, columns) = factor.matrixLLT()
                                               .bottomRightCorner(left, left)
                                               .triangularView<Eigen::Lower>()
                                               .solve(Eigen::MatrixXd::Identity(left, columns));
    }
    for (Eigen::Index i = 0; i < n; i += kColumns) {
        const Eigen::Index left = n - i, rows = std::min(kColumns, left), columns = i + rows;
        inverse.block(i, 0, rows, columns).noalias() =
            lower.block(i, i, left, rows).transpose() * lower.block(i, 0, left, columns);
        inverse.block(0, i, columns, rows) = inverse.block(i, 0, rows, columns).transpose().eval();
    }
    return inverse.allFinite() ? inverse : Eigen::MatrixXd();
}

/// Of a small piece; the numbers that it does not need stay out of it. Empty as above.
Eigen::MatrixXd pieceInverseOf(Eigen::MatrixXd piece)
{
    std::vector<Eigen::Index> unused;
    for (Eigen::Index i = 0; i < piece.rows(); ++i)
        if (piece(i, i) == 0.0) unused.push_back(i);
    for (Eigen::Index i : unused) piece(i, i) = 1.0;
    Eigen::MatrixXd inverse = inverseOf(std::move(piece));
    for (Eigen::Index i : unused)
        if (inverse.size() > 0) inverse(i, i) = 0.0;
    return inverse;
}

void writePanels(const Eigen::MatrixXd& inverse, int rows, PanelRow* panels)
{
    for (Eigen::Index i = 0; i < inverse.rows(); ++i)
        for (Eigen::Index j = 0; j < inverse.cols(); ++j)
            panels[j / kBlock * rows + i].values[j % kBlock] =
                static_cast<float>(0.5 * (inverse(i, j) + inverse(j, i)));
}

} // namespace

struct TwoLevelPreconditioner::CoarseInverse {
    Eigen::MatrixXd lattice;
    std::vector<Eigen::MatrixXd> pieces;
};

TwoLevelPreconditioner::TwoLevelPreconditioner(const PreconditionerInput& in)
{
    grow(std::max(in.blocks, blocksFor(static_cast<int>(in.rows.size()))));
    for (std::size_t i = 0; i < in.rows.size(); ++i)
        setDiagonal(static_cast<int>(i), in.scale * in.matrix.block(in.matrix.find(in.rows[i], in.rows[i])));
    if (in.coarseNodes == 0 && in.freePieces.empty()) return;
    CoarseMatrix coarse = galerkin(in);
    CoarseInverse inverse;
    if (in.coarseNodes > 0) inverse.lattice = inverseOf(std::move(coarse.lattice));
    for (Eigen::MatrixXd& each : coarse.pieces) inverse.pieces.push_back(pieceInverseOf(std::move(each)));
    makeCoarseLevel(inverse, {{}, {}, in.freePieces, in.coarseNodes, in.rows, in.corners, in.weights});
}

TwoLevelPreconditioner::TwoLevelPreconditioner(const CoarseInput& in)
{
    rotations_.resize(static_cast<std::size_t>(blocksFor(static_cast<int>(in.rows.size()))));
    const auto matrixOf = [](const double* rows, Eigen::Index unknowns) -> Eigen::MatrixXd {
        return Eigen::Map<const Eigen::MatrixXd>(rows, unknowns, unknowns).transpose();
    };
    CoarseInverse inverse;
    if (in.coarseNodes > 0) inverse.lattice = quickInverseOf(matrixOf(in.matrix.data(), 3 * in.coarseNodes));
    constexpr std::size_t kNumbers = static_cast<std::size_t>(kPieceUnknowns) * kPieceUnknowns;
    for (std::size_t at = 0; at < in.pieces.size(); at += kNumbers)
        inverse.pieces.push_back(pieceInverseOf(matrixOf(in.pieces.data() + at, kPieceUnknowns)));
    makeCoarseLevel(inverse, in);
}

void TwoLevelPreconditioner::grow(int blocks)
{
    RotationBlock identity{};
    for (int k : {0, 4, 8}) std::fill(std::begin(identity.m[k]), std::end(identity.m[k]), 1.0f);
    const auto count = static_cast<std::size_t>(blocks);
    rotations_.resize(count, identity);
    inverseDiagonal_.resize(count);
    if (coarseNodes_ > 0) interpolation_.resize(count);
    rest_ = NodeArray(blocks);
    smoothed_ = NodeArray(blocks);
    sums_.resize(static_cast<std::size_t>(nodeParts(blocks).count()));
}

void TwoLevelPreconditioner::setDiagonal(int node, const Mat3& block)
{
    setBlock(inverseDiagonal_, node, inverse(block));
}

Interpolation TwoLevelPreconditioner::interpolation(int node) const
{
    Interpolation how;
    if (coarseNodes_ == 0) return how;
    const InterpolationBlock& block = interpolation_[static_cast<std::size_t>(node / kBlock)];
    for (std::size_t k = 0; k < 4; ++k) {
        how.corners[k] = block.at[node % kBlock][k] / 3;
        how.weights[k] = block.weights[node % kBlock][k];
    }
    return how;
}

void TwoLevelPreconditioner::interpolate(int node, const Interpolation& how)
{
    if (coarseNodes_ == 0) return;
    InterpolationBlock& block = interpolation_[static_cast<std::size_t>(node / kBlock)];
    for (std::size_t k = 0; k < 4; ++k) {
        const auto before = static_cast<std::size_t>(block.at[node % kBlock][k] / 3);
        if (const float weight = block.weights[node % kBlock][k]; weight != 0.0f)
            restriction_.remove(before, {node, weight});
        block.at[node % kBlock][k] = 3 * how.corners[k];
        block.weights[node % kBlock][k] = how.weights[k];
        if (how.weights[k] != 0.0f) restriction_.add(static_cast<std::size_t>(how.corners[k]), {node, how.weights[k]});
    }
}

void TwoLevelPreconditioner::makeCoarseLevel(const CoarseInverse& inverse, const CoarseInput& in)
{
    if (in.coarseNodes > 0 && inverse.lattice.size() == 0) return;
    const int pieces = static_cast<int>(inverse.pieces.size());
    latticeNodes_ = in.coarseNodes;
    coarseNodes_ = pieces == 0 ? latticeNodes_ : firstPieceNode(latticeNodes_) + pieces * kPieceNodes;
    const int unknowns = 3 * coarseNodes_, rows = latticeRows();
    coarseResidual_.assign(static_cast<std::size_t>(fours(unknowns)), 0.0f);
    coarse_.assign(static_cast<std::size_t>(blocksFor(unknowns) * kBlock + 4), 0.0f);
    coarseInverse_.assign(static_cast<std::size_t>(blocksFor(3 * latticeNodes_)) * static_cast<std::size_t>(rows), {});
    writePanels(inverse.lattice, rows, coarseInverse_.data());
    freePieces_.assign(in.freePieces.begin(), in.freePieces.end());
    pieceInverses_.assign(static_cast<std::size_t>(pieces) * kPieceRows, {});
    for (std::size_t p = 0; p < inverse.pieces.size(); ++p)
        writePanels(inverse.pieces[p], kPieceUnknowns, pieceInverses_.data() + p * kPieceRows);

    interpolation_.assign(rotations_.size(), {});
    std::vector<std::vector<RestrictionEntry>> entries(static_cast<std::size_t>(coarseNodes_));
    for (std::size_t i = 0; i < in.rows.size(); ++i)
        for (std::size_t k = 0; k < 4; ++k) {
            const int corner = in.corners[in.rows[i]][k];
            const float weight = in.weights[in.rows[i]][k];
            interpolation_[i / kBlock].at[i % kBlock][k] = 3 * corner;
            interpolation_[i / kBlock].weights[i % kBlock][k] = weight;
            if (weight != 0.0f) entries[corner].push_back({static_cast<int>(i), weight});
        }
    restriction_ = Restriction(entries);
}

bool TwoLevelPreconditioner::takeCoarseLevel(TwoLevelPreconditioner&& from)
{
    if (from.coarseNodes_ == 0) return false;
    coarseNodes_ = from.coarseNodes_;
    latticeNodes_ = from.latticeNodes_;
    interpolation_ = std::move(from.interpolation_);
    interpolation_.resize(rotations_.size());
    restriction_ = std::move(from.restriction_);
    coarseInverse_ = std::move(from.coarseInverse_);
    pieceInverses_ = std::move(from.pieceInverses_);
    freePieces_ = std::move(from.freePieces_);
    coarseResidual_ = std::move(from.coarseResidual_);
    coarse_ = std::move(from.coarse_);
    return true;
}

double TwoLevelPreconditioner::apply(const NodeArray& r, NodeArray& z, WorkerPool& pool)
{
    smooth(r, pool);
    return spread(r, z, pool);
}

void TwoLevelPreconditioner::smooth(const NodeArray& r, WorkerPool& pool)
{
    const Parts nodes = nodeParts(r.blocks());
    pool.run(nodes.count(),
             [&](int part) { warpAndSmooth(rotations_, inverseDiagonal_, r, rest_, smoothed_, nodes[part]); });
}

void TwoLevelPreconditioner::restrictResidual(WorkerPool& pool)
{
    const Parts coarse = coarseNodeParts(coarseNodes_);
    pool.run(coarse.count(),
             [&](int part) { restrictTo(restriction_, rest_, coarseResidual_, coarse[part].begin, coarse[part].end); });
}

double TwoLevelPreconditioner::spread(const NodeArray& r, NodeArray& z, WorkerPool& pool,
                                      std::span<const double> shares)
{
    if (coarseNodes_ > 0) {
        const Parts panels = panelParts(blocksFor(3 * latticeNodes_));
        if (shares.empty()) restrictResidual(pool); // else weigh() has done it
        const auto rows = std::span<const float>(coarseResidual_).first(static_cast<std::size_t>(latticeRows()));
        pool.run(panels.count(), [&](int part) {
            multiplyPanels(coarseInverse_, rows, coarse_, panels[part].begin, panels[part].end);
        });
        answerPieces(coarseResidual_, coarse_);
        const float* answered = answered_.data();
        for (std::size_t p = 0; p < shares.size(); ++p, answered += coarse_.size())
            for (std::size_t k = 0; k < coarse_.size(); ++k) coarse_[k] -= static_cast<float>(shares[p]) * answered[k];
    }
    return sumOfParts(pool, nodeParts(r.blocks()), sums_, [&](Blocks blocks) {
        return prolongAndUnwarp(rotations_, interpolation_, coarse_, smoothed_, r, z, blocks);
    });
}

int TwoLevelPreconditioner::latticeRows() const { return fours(3 * latticeNodes_); }

void TwoLevelPreconditioner::clearPulls()
{
    pulls_ = 0;
    felt_.clear();
    answered_.clear();
    answeredRows_.clear();
}

void TwoLevelPreconditioner::addPull(std::span<const NodePull> pull)
{
    const std::size_t rows = coarseResidual_.size();
    felt_.resize(felt_.size() + rows);
    const std::span<float> felt = std::span(felt_).last(rows);
    ++pulls_;
    for (const NodePull& each : pull) {
        const Vec3 rest = transposeTimes(rotation(each.node), each.pull);
        const InterpolationBlock& block = interpolation_[static_cast<std::size_t>(each.node / kBlock)];
        for (int k = 0; k < 4; ++k)
            for (int i = 0; i < 3; ++i)
                felt[static_cast<std::size_t>(block.at[each.node % kBlock][k] + i)] +=
                    block.weights[each.node % kBlock][k] * static_cast<float>(rest[i]);
    }
}

void TwoLevelPreconditioner::answerPulls()
{
    const std::size_t rows = coarseResidual_.size(), entries = coarse_.size(), pulls = static_cast<std::size_t>(pulls_);
    answered_.assign(pulls * entries, 0.0f);
    const auto onLattice = [&](std::size_t pull) {
        return std::ranges::any_of(std::span(felt_).subspan(pull * rows, 3 * static_cast<std::size_t>(latticeNodes_)),
                                   [](float each) { return each != 0.0f; });
    };
    // Runs of pulls that reach the lattice go together; to those at small pieces alone it has no answer.
    for (std::size_t p = 0, end = 0; p < pulls; p = end + 1) {
        for (end = p; end < pulls && onLattice(end);) ++end;
        multiplyPanels(coarseInverse_, std::span(felt_).subspan(p * rows), std::span(answered_).subspan(p * entries),
                       {.count = static_cast<int>(end - p),
                        .rows = latticeRows(),
                        .stride = static_cast<int>(rows),
                        .answerStride = static_cast<int>(entries)},
                       blocksFor(3 * latticeNodes_));
    }
    for (std::size_t p = 0; p < pulls; ++p)
        answerPieces(std::span(felt_).subspan(p * rows, rows), std::span(answered_).subspan(p * entries, entries));
    answeredRows_.assign(static_cast<std::size_t>(blocksFor(pulls_)) * rows, {});
    for (std::size_t p = 0; p < pulls; ++p)
        for (std::size_t k = 0; k < static_cast<std::size_t>(3 * coarseNodes_); ++k)
            answeredRows_[p / kBlock * rows + k].values[p % kBlock] = answered_[p * entries + k];
}

void TwoLevelPreconditioner::answers(int pull, std::span<double> out) const
{
    const std::size_t rows = coarseResidual_.size();
    std::vector<float> sums(static_cast<std::size_t>(blocksFor(pulls_) * kBlock));
    multiplyPanels(answeredRows_, std::span(felt_).subspan(static_cast<std::size_t>(pull) * rows, rows), sums, 0,
                   blocksFor(pulls_));
    std::copy_n(sums.begin(), out.size(), out.begin());
}

void TwoLevelPreconditioner::weigh(std::span<double> sums, WorkerPool& pool)
{
    restrictResidual(pool);
    weighed_.resize(static_cast<std::size_t>(blocksFor(pulls_) * kBlock));
    multiplyPanels(answeredRows_, coarseResidual_, weighed_, 0, blocksFor(pulls_));
    std::copy_n(weighed_.begin(), sums.size(), sums.begin());
}

Mat3 TwoLevelPreconditioner::rotation(int node) const
{
    const auto& m = rotations_[static_cast<std::size_t>(node / kBlock)].m;
    const auto at = [&](int k) { return static_cast<double>(m[k][node % kBlock]); };
    return {{{at(0), at(1), at(2)}, {at(3), at(4), at(5)}, {at(6), at(7), at(8)}}};
}

void TwoLevelPreconditioner::addToSpread(int node, Vec3 change)
{
    const Vec3 rest = transposeTimes(rotation(node), change);
    float* s = rest_[node];
    for (int k = 0; k < 3; ++k) s[k] += static_cast<float>(rest[k]);
}

Mat3 TwoLevelPreconditioner::inverseDiagonal(int node) const
{
    const auto& m = inverseDiagonal_[static_cast<std::size_t>(node / kBlock)].m;
    const auto at = [&](int k) { return static_cast<double>(m[k][node % kBlock]); };
    const Mat3 rest{{{at(0), at(1), at(2)}, {at(1), at(3), at(4)}, {at(2), at(4), at(5)}}};
    const Mat3 turn = rotation(node);
    return turn * rest * transpose(turn);
}

} // namespace filasofia::linalg
