#include "filasofia/linalg/block_sparse_matrix.h"
#include "filasofia/linalg/linear_solver.h"

#include <Eigen/SparseCholesky>

#include <algorithm>

namespace filasofia::linalg {
namespace {

using Lower = Eigen::SparseMatrix<double>;

class Cholesky final : public LinearSolver {
public:
    SolveReport solve(const LinearOperator& a, std::span<const Vec3> b, std::span<Vec3> x) override
    {
        const BlockSparseMatrix& entries = a.entries();
        if (entries.columns() != columns_ || entries.rowStarts() != rowStarts_) analyse(entries);
        copyValues(entries);
        factor_.factorize(lower_);
        const auto size = static_cast<Eigen::Index>(3 * b.size());
        Eigen::VectorXd solution;
        if (factor_.info() == Eigen::Success)
            solution = factor_.solve(Eigen::Map<const Eigen::VectorXd>(&b[0].x, size));
        if (solution.size() == 0 || !solution.allFinite()) { // no answer: zero is safer than the guess
            std::fill(x.begin(), x.end(), Vec3{});
            return {.iterations = 1, .residual = 1.0, .converged = false};
        }
        Eigen::Map<Eigen::VectorXd>(&x[0].x, size) = solution;
        return {.iterations = 1, .residual = residual(a, b, x)};
    }

    [[nodiscard]] bool isDirect() const override { return true; }
    bool solveAgain(std::span<const Vec3> b, std::span<Vec3> x) override
    {
        if (factor_.info() != Eigen::Success || factor_.rows() != static_cast<Eigen::Index>(3 * b.size())) return false;
        const auto size = static_cast<Eigen::Index>(3 * b.size());
        Eigen::Map<Eigen::VectorXd>(&x[0].x, size) = factor_.solve(Eigen::Map<const Eigen::VectorXd>(&b[0].x, size));
        return true;
    }

private:
    /// Sets the pattern of the lower triangle, column by column. A is symmetric, so row r of A from its diagonal on is
    /// column r of the lower triangle.
    void analyse(const BlockSparseMatrix& a)
    {
        columns_ = a.columns();
        rowStarts_ = a.rowStarts();
        const int n = a.rows();
        lower_ = Lower(3 * n, 3 * n);
        std::vector<Eigen::Triplet<double>> pattern;
        for (int r = 0; r < n; ++r)
            for (int p = rowStarts_[r]; p < rowStarts_[r + 1]; ++p)
                if (columns_[p] >= r)
                    for (int i = 0; i < 3; ++i)
                        for (int j = columns_[p] == r ? i : 0; j < 3; ++j)
                            pattern.emplace_back(3 * columns_[p] + j, 3 * r + i, 1.0);
        lower_.setFromTriplets(pattern.begin(), pattern.end());
        factor_.analyzePattern(lower_);
    }

    void copyValues(const BlockSparseMatrix& a)
    {
        // Compressed columns: scalar column 3 r + i holds, in order of rows, the entries of the blocks from r on.
        double* value = lower_.valuePtr();
        for (int r = 0; r < a.rows(); ++r)
            for (int i = 0; i < 3; ++i)
                for (int p = rowStarts_[r]; p < rowStarts_[r + 1]; ++p)
                    if (columns_[p] >= r)
                        for (int j = columns_[p] == r ? i : 0; j < 3; ++j) *value++ = a.block(p)[i][j];
    }

    double residual(const LinearOperator& a, std::span<const Vec3> b, std::span<const Vec3> x)
    {
        product_.resize(b.size());
        a.multiply(x, product_);
        double error = 0.0, size = 0.0;
        for (std::size_t i = 0; i < b.size(); ++i) {
            error += lengthSquared(b[i] - product_[i]);
            size += lengthSquared(b[i]);
        }
        return size > 0.0 ? std::sqrt(error / size) : 0.0;
    }

    std::vector<int> columns_, rowStarts_; ///< the block structure that was analysed
    Lower lower_;
    Eigen::SimplicialLLT<Lower, Eigen::Lower, Eigen::AMDOrdering<int>> factor_;
    std::vector<Vec3> product_;
};

} // namespace

std::unique_ptr<LinearSolver> makeCholesky() { return std::make_unique<Cholesky>(); }

} // namespace filasofia::linalg
