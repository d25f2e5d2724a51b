#include "filasofia/linalg/sparse_cholesky.h"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <vector>

namespace filasofia::linalg {
namespace {

/// What Eigen asks of an entry.
struct Triplet : SparseCholesky::Entry {
    [[nodiscard]] int row() const { return Entry::row; }
    [[nodiscard]] int col() const { return column; }
    [[nodiscard]] double value() const { return Entry::value; }
};

} // namespace

struct SparseCholesky::Factor {
    Eigen::SparseMatrix<double> matrix;
    std::vector<int> columns, rows; ///< the pattern that was analysed
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::AMDOrdering<int>> llt;
};

SparseCholesky::SparseCholesky() : factor_(std::make_unique<Factor>()) {}
SparseCholesky::~SparseCholesky() = default;
SparseCholesky::SparseCholesky(SparseCholesky&&) noexcept = default;
SparseCholesky& SparseCholesky::operator=(SparseCholesky&&) noexcept = default;

bool SparseCholesky::factorise(std::span<const Entry> lower, int n)
{
    auto& [matrix, columns, rows, llt] = *factor_;
    std::vector<Triplet> triplets;
    triplets.reserve(lower.size());
    for (const Entry& each : lower) triplets.push_back({each});
    matrix.resize(n, n);
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    const std::span starts(matrix.outerIndexPtr(), static_cast<std::size_t>(n) + 1);
    const std::span entries(matrix.innerIndexPtr(), static_cast<std::size_t>(matrix.nonZeros()));
    if (!std::ranges::equal(starts, columns) || !std::ranges::equal(entries, rows)) {
        columns.assign(starts.begin(), starts.end());
        rows.assign(entries.begin(), entries.end());
        llt.analyzePattern(matrix);
    }
    llt.factorize(matrix);
    return llt.info() == Eigen::Success;
}

void SparseCholesky::solve(std::span<double> x) const
{
    Eigen::Map<Eigen::VectorXd> in(x.data(), static_cast<Eigen::Index>(x.size()));
    in = factor_->llt.solve(in).eval();
}

} // namespace filasofia::linalg
