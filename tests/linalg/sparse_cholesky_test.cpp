#include "filasofia/linalg/sparse_cholesky.h"

#include <Eigen/Dense>

#include <random>

namespace sparse_cholesky_test {

using filasofia::linalg::SparseCholesky;

TEST_CASE("a sparse factor solves, whether its pattern is new or not, and reports a matrix that has none")
{
    std::mt19937 random(1);
    std::normal_distribution<double> number;
    SparseCholesky factor; // one for all: it must notice another pattern
    for (const int n : {1, 3, 60, 60, 61}) {
        Eigen::MatrixXd a = 0.1 * Eigen::MatrixXd::Identity(n, n);
        std::vector<SparseCholesky::Entry> entries;
        for (int i = 0; i < n; ++i) entries.push_back({i, i, 0.1});
        for (int k = 0; k < 3 * n; ++k) { // springs between random pairs of unknowns
            const int i = static_cast<int>(random() % static_cast<unsigned>(n)),
                      j = static_cast<int>(random() % static_cast<unsigned>(n));
            const double stiffness = 0.1 + std::abs(number(random));
            a(i, i) += stiffness;
            entries.push_back({i, i, stiffness});
            if (i == j) continue;
            a(j, j) += stiffness;
            a(i, j) -= stiffness;
            a(j, i) -= stiffness;
            entries.push_back({j, j, stiffness});
            entries.push_back({std::max(i, j), std::min(i, j), -stiffness});
        }
        const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(n, [&] { return number(random); });
        std::vector<double> x(b.data(), b.data() + n);
        REQUIRE(factor.factorise(entries, n));
        factor.solve(x);
        CHECK((a * Eigen::Map<Eigen::VectorXd>(x.data(), n) - b).norm() <= 1e-11 * b.norm() * n);
        entries.push_back({n - 1, n - 1, -1e3});
        CHECK_FALSE(factor.factorise(entries, n));
    }
}

} // namespace sparse_cholesky_test
