#include "filasofia/linalg/dense_cholesky.h"

#include <Eigen/Dense>

#include <random>

namespace dense_cholesky_test {

using filasofia::linalg::DenseCholesky;

TEST_CASE("a dense factor solves, and reports a matrix that has none")
{
    std::mt19937 random(1);
    std::normal_distribution<double> number;
    for (const int n : {1, 3, 48, 130}) {
        const Eigen::MatrixXd half = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return number(random); });
        const Eigen::MatrixXd a = half * half.transpose() + Eigen::MatrixXd::Identity(n, n);
        const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(n, [&] { return number(random); });
        std::vector<double> matrix(static_cast<std::size_t>(n * n)), x(b.data(), b.data() + n);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j)
                matrix[static_cast<std::size_t>(i * n + j)] = j <= i ? a(i, j) : 1e9; // not read
        DenseCholesky factor;
        REQUIRE(factor.factorise(matrix, n));
        factor.solve(x);
        CHECK((a * Eigen::Map<Eigen::VectorXd>(x.data(), n) - b).norm() <= 1e-10 * b.norm() * n);
        matrix.back() = -1.0;
        CHECK_FALSE(factor.factorise(matrix, n));
    }
}

} // namespace dense_cholesky_test
