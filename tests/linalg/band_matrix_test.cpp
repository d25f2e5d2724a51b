#include "filasofia/linalg/band_matrix.h"

#include <Eigen/Dense>

namespace band_matrix_test {

using namespace filasofia::linalg;

namespace {

/// A random positive definite band matrix, and the same as a dense one.
struct Sample {
    BandMatrix band;
    Eigen::MatrixXd dense;

    explicit Sample(std::size_t n) : band(n)
    {
        std::mt19937 random(static_cast<unsigned>(n));
        std::uniform_real_distribution<double> draw(-1.0, 1.0);
        dense = Eigen::MatrixXd::Zero(static_cast<long>(n), static_cast<long>(n));
        for (std::size_t j = 0; j < n; ++j)
            for (std::size_t i = j; i < std::min(n, j + BandMatrix::kWidth + 1); ++i) {
                band.at(i, j) = draw(random) + (i == j ? 12.0 : 0.0);
                dense(static_cast<long>(i), static_cast<long>(j)) = dense(static_cast<long>(j), static_cast<long>(i)) =
                    band.at(i, j);
            }
    }
};

/// Checks product and solution against a dense matrix; leaves the factor.
void checkSolved(const BandMatrix& band, const Eigen::MatrixXd& dense, BandCholesky& factor)
{
    const auto size = dense.rows();
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(size, -1.0, 2.0);
    std::vector<double> in(x.data(), x.data() + size), out(in.size());
    band.multiply(in, out);
    CHECK((Eigen::Map<Eigen::VectorXd>(out.data(), size) - dense * x).norm() < 1e-12);
    REQUIRE(factor.factorise(band));
    factor.solve(out);
    CHECK((Eigen::Map<Eigen::VectorXd>(out.data(), size) - x).norm() < 1e-12);
}

} // namespace

TEST_CASE("a band matrix multiplies, solves and inverts as a dense one does")
{
    for (const std::size_t n : {1, 3, 11, 12, 57}) {
        const Sample sample(n);
        BandCholesky factor;
        checkSolved(sample.band, sample.dense, factor);
        BandMatrix inverse;
        factor.invert(inverse);
        const Eigen::MatrixXd exact = sample.dense.inverse();
        for (std::size_t j = 0; j < n; ++j)
            for (std::size_t i = j; i < std::min(n, j + BandMatrix::kWidth + 1); ++i)
                CHECK_THAT(inverse.at(i, j),
                           Catch::WithinAbs(exact(static_cast<long>(i), static_cast<long>(j)), 1e-12));
    }
}

TEST_CASE("a cyclic band matrix multiplies, solves and inverts as a dense one does, and is refused as one")
{
    constexpr std::size_t corner = BandMatrix::kCorner;
    for (const std::size_t n : {26, 32, 57}) {
        Sample sample(n);
        BandMatrix cyclic(n, true);
        std::mt19937 random(7);
        std::uniform_real_distribution<double> draw(-0.5, 0.5);
        for (std::size_t j = 0; j < n; ++j)
            for (std::size_t i = j; i < std::min(n, j + BandMatrix::kWidth + 1); ++i)
                cyclic.add(j, i, sample.band.at(i, j));
        for (std::size_t r = 0; r < corner; ++r)
            for (std::size_t c = 0; c < corner; ++c) {
                const double value = draw(random);
                cyclic.add(c, n - corner + r, value);
                const auto row = static_cast<long>(n - corner + r), column = static_cast<long>(c);
                sample.dense(row, column) = sample.dense(column, row) = value;
                CHECK(cyclic.entry(n - corner + r, c) == value);
            }
        BandCholesky factor;
        checkSolved(cyclic, sample.dense, factor);
        BandMatrix inverse;
        factor.invert(inverse);
        const Eigen::MatrixXd exact = sample.dense.inverse();
        for (std::size_t j = 0; j < n; ++j)
            for (std::size_t i = j; i < n; ++i)
                if (i - j <= BandMatrix::kWidth || (j < corner && i + corner >= n))
                    CHECK_THAT(inverse.entry(i, j),
                               Catch::WithinAbs(exact(static_cast<long>(i), static_cast<long>(j)), 1e-12));
        cyclic.add(n - 1, n - 1, -50.0);
        CHECK_FALSE(factor.factorise(cyclic));
        REQUIRE(factor.factorise(sample.band)); // the same factor of a matrix without a corner
        CHECK(factor.factorise(sample.band));
    }
}

TEST_CASE("a band matrix that is not positive definite is refused")
{
    Sample sample(20);
    sample.band.at(7, 7) = -1.0;
    CHECK_FALSE(BandCholesky().factorise(sample.band));
    sample.band.at(7, 7) = std::nan("");
    CHECK_FALSE(BandCholesky().factorise(sample.band));
}

} // namespace band_matrix_test
