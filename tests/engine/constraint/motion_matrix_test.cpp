#include "filasofia/engine/constraint/motion_matrix.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <random>

namespace motion_matrix_test {

using namespace filasofia;
using namespace filasofia::engine;

TEST_CASE("a motion matrix of few motions, factorised as dense, and of many, as sparse, is inverted")
{
    std::mt19937 random(3);
    const auto number = [&] { return std::uniform_real_distribution(-1.0, 1.0)(random); };
    for (const int size : {1, 40, 300}) {
        MotionMatrix matrix;
        matrix.begin(static_cast<std::size_t>(size));
        Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * size, 3 * size);
        // Stiffnesses between motions that are near each other in a ring, each counted twice.
        for (int each = 0; each < 4 * size; ++each) {
            const int a = each % size, b = (a + each / size + 1) % size;
            const auto [low, high] = std::minmax(a, b);
            const Eigen::Matrix<double, 3, 6> half =
                Eigen::Matrix<double, 3, 6>::NullaryExpr([&](Eigen::Index, Eigen::Index) { return number(); });
            const Eigen::Matrix<double, 6, 6> stiffness =
                half.transpose() * half + Eigen::Matrix<double, 6, 6>::Identity();
            const auto add = [&](int row, int column, const Eigen::Matrix3d& block) {
                Mat3 out;
                for (int r = 0; r < 3; ++r)
                    for (int c = 0; c < 3; ++c) out[r][c] = block(r, c);
                matrix.add(static_cast<std::size_t>(row), static_cast<std::size_t>(column), out);
                dense.block<3, 3>(3 * row, 3 * column) += block;
                if (row != column) dense.block<3, 3>(3 * column, 3 * row) += block.transpose();
            };
            add(low, low, stiffness.topLeftCorner<3, 3>());
            if (low == high) continue;
            add(high, high, stiffness.bottomRightCorner<3, 3>());
            add(high, low, stiffness.bottomLeftCorner<3, 3>());
        }
        matrix.shiftDiagonal();
        REQUIRE(matrix.factorise());
        std::vector<Vec3> x(static_cast<std::size_t>(size));
        Eigen::VectorXd right(3 * size);
        for (int i = 0; i < 3 * size; ++i) x[static_cast<std::size_t>(i / 3)][i % 3] = right(i) = number();
        matrix.solve(x);
        const Eigen::VectorXd exact = dense.ldlt().solve(right);
        double worst = 0.0;
        for (int i = 0; i < 3 * size; ++i)
            worst = std::max(worst, std::abs(x[static_cast<std::size_t>(i / 3)][i % 3] - exact(i)));
        CHECK(worst < 1e-4 * exact.norm()); // up to the shift
    }
}

TEST_CASE("a motion that nothing resists takes no part, and a matrix that is not positive definite is told")
{
    MotionMatrix matrix;
    matrix.begin(2);
    matrix.add(0, 0, 2.0 * Mat3::identity());
    matrix.shiftDiagonal();
    REQUIRE(matrix.factorise());
    std::vector<Vec3> x{{2, 4, 6}, {}};
    matrix.solve(x);
    CHECK(length(x[0] - Vec3{1, 2, 3}) < 1e-5);
    CHECK(x[1] == Vec3{});

    matrix.begin(2);
    matrix.add(0, 0, Mat3::identity());
    matrix.add(1, 1, Mat3::identity());
    matrix.add(1, 0, 2.0 * Mat3::identity());
    matrix.shiftDiagonal();
    CHECK_FALSE(matrix.factorise());
}

} // namespace motion_matrix_test
