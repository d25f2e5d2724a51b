#include "filasofia/linalg/block_cholesky.h"

#include <Eigen/Dense>

#include <random>

namespace block_cholesky_test {

using namespace filasofia;
using linalg::BlockCholesky;

namespace {

/// The same matrix twice: its blocks, and written out.
struct Problem {
    std::vector<BlockCholesky::Place> places;
    std::vector<Mat3> blocks;
    Eigen::MatrixXd matrix;

    explicit Problem(int n) : matrix(Eigen::MatrixXd::Zero(3 * n, 3 * n)) {}
    void add(int row, int column, const Mat3& value)
    {
        places.push_back({row, column});
        blocks.push_back(value);
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k) {
                matrix(3 * row + i, 3 * column + k) += value[i][k];
                if (row != column) matrix(3 * column + k, 3 * row + i) += value[i][k];
            }
    }
};

} // namespace

TEST_CASE("a block factor solves, whether its pattern is new or not, and reports a matrix that has none")
{
    std::mt19937 random(1);
    std::normal_distribution<double> number;
    const auto vector = [&] { return Vec3{number(random), number(random), number(random)}; };
    BlockCholesky factor; // one for all: it must notice another pattern
    for (const int n : {1, 3, 60, 60, 61}) {
        CAPTURE(n);
        Problem problem(n);
        for (int i = 0; i < n; ++i) problem.add(i, i, 0.1 * Mat3::identity());
        for (int k = 0; k < 2 * n; ++k) { // springs between random pairs of unknowns, in any direction
            const int i = static_cast<int>(random() % static_cast<unsigned>(n)),
                      j = static_cast<int>(random() % static_cast<unsigned>(n));
            const Vec3 a = vector(), b = vector();
            problem.add(i, i, outer(a, a));
            if (i == j) continue;
            problem.add(j, j, outer(b, b));
            problem.add(std::max(i, j), std::min(i, j), i > j ? outer(a, b) : outer(b, a));
        }
        for (int again = 0; again < 2; ++again) { // the second time, the pattern is known
            std::vector<Vec3> x(static_cast<std::size_t>(n));
            for (Vec3& each : x) each = vector();
            const Eigen::VectorXd b = Eigen::Map<Eigen::VectorXd>(&x[0].x, 3 * n);
            factor.analyse(problem.places, n);
            REQUIRE(factor.factorise(problem.blocks));
            factor.solve(x);
            CHECK((problem.matrix * Eigen::Map<Eigen::VectorXd>(&x[0].x, 3 * n) - b).norm() <= 1e-10 * b.norm() * n);
        }
        problem.add(n - 1, n - 1, -1e3 * Mat3::identity());
        factor.analyse(problem.places, n);
        CHECK_FALSE(factor.factorise(problem.blocks));
        problem.add(n - 1, n - 1, std::numeric_limits<double>::quiet_NaN() * Mat3::identity());
        factor.analyse(problem.places, n);
        CHECK_FALSE(factor.factorise(problem.blocks));
    }
}

TEST_CASE("a block factor of nothing solves nothing")
{
    BlockCholesky factor;
    factor.analyse({}, 0);
    REQUIRE(factor.factorise({}));
    factor.solve({});
}

} // namespace block_cholesky_test
