#include "filasofia/linalg/dense_cholesky.h"

#include "filasofia/linalg/eigen_blocking.h"

#include <Eigen/Cholesky>

namespace filasofia::linalg {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

} // namespace

bool DenseCholesky::factorise(std::span<const double> matrix, int n)
{
    fixBlocking();
    lower_.assign(matrix.begin(), matrix.end());
    Eigen::Map<RowMajor> in(lower_.data(), n, n);
    const Eigen::LLT<Eigen::Ref<RowMajor>> factor(in); // in place
    return factor.info() == Eigen::Success && in.allFinite();
}

void DenseCholesky::solve(std::span<double> x) const
{
    const auto n = static_cast<Eigen::Index>(x.size());
    const Eigen::Map<const RowMajor> lower(lower_.data(), n, n);
    Eigen::Map<Eigen::VectorXd> in(x.data(), n);
    lower.triangularView<Eigen::Lower>().solveInPlace(in);
    lower.triangularView<Eigen::Lower>().transpose().solveInPlace(in);
}

} // namespace filasofia::linalg
