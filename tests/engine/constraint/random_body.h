#pragma once

#include "filasofia/engine/constraint/body_operator.h"

#include <Eigen/Dense>

#include <random>
#include <vector>

namespace filasofia::engine {

/// Any positive definite D of blocks, coupled or not, and any J per contact point.
struct RandomBody final : BodySmoother {
    Eigen::MatrixXd d;
    std::vector<Eigen::MatrixXd> j; ///< per point: three rows

    RandomBody(std::mt19937& random, int blocks, int points, bool diagonal) : diagonal_(diagonal)
    {
        std::normal_distribution<double> number;
        const auto any = [&] { return number(random); };
        const Eigen::Index size = 3 * blocks;
        const Eigen::MatrixXd half = Eigen::MatrixXd::NullaryExpr(size, size, any);
        d = half * half.transpose() + 0.1 * Eigen::MatrixXd::Identity(size, size);
        for (Eigen::Index i = 0; i < size; ++i)
            for (Eigen::Index k = 0; k < size; ++k)
                if (diagonal && i / 3 != k / 3) d(i, k) = 0.0;
        for (int p = 0; p < points; ++p) {
            j.emplace_back(Eigen::MatrixXd::NullaryExpr(3, size, any));
            if (diagonal) j.back().middleCols(3 * (p % blocks), 3).setZero();    // a point that misses a block
            if (!diagonal && p % 2 == 1) j.back().rightCols(size - 3).setZero(); // others follow it through D
        }
    }
    [[nodiscard]] Mat3 compliance(int) const override { return {}; }
    void addColumns(int point, std::vector<BlockColumns>& out) const override
    {
        const Eigen::MatrixXd& rows = j[static_cast<std::size_t>(point)];
        for (int b = 0; 3 * b < rows.cols(); ++b)
            if (!rows.middleCols<3>(3 * b).isZero(0.0)) out.push_back({b, at(rows, 0, b)});
    }
    [[nodiscard]] Mat3 block(int row, int column) const override { return at(d, row, column); }
    void addPlaces(std::vector<BlockPlace>& out) const override
    {
        for (int row = 1; !diagonal_ && 3 * row < d.rows(); ++row)
            for (int column = 0; column < row; ++column) out.push_back({row, column});
    }

private:
    static Mat3 at(const Eigen::MatrixXd& m, int row, int column)
    {
        Mat3 out;
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 3; ++k) out[i][k] = m(3 * row + i, 3 * column + k);
        return out;
    }
    bool diagonal_;
};

} // namespace filasofia::engine
