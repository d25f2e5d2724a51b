#include "filasofia/linalg/factor_kernels.h"

#include "linalg/random_matrix.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace factor_kernels_test {

using namespace filasofia;
using namespace filasofia::linalg;

namespace {

constexpr std::size_t kWidth = kBandEntries - 1;

/// A random positive definite band, with the columns of zeros behind it.
std::vector<double> randomBand(std::size_t rows, std::mt19937& random)
{
    std::uniform_real_distribution<double> draw(-1.0, 1.0);
    std::vector<double> columns((rows + kWidth) * kBandColumn);
    for (std::size_t j = 0; j < rows; ++j)
        for (std::size_t k = 0; k < std::min(kBandEntries, rows - j); ++k)
            columns[kBandColumn * j + k] = draw(random) + (k == 0 ? 12.0 : 0.0);
    return columns;
}

// The same in plain loops.

void plainFactor(std::vector<double>& columns, std::size_t rows)
{
    for (std::size_t j = 0; j < rows; ++j) {
        double* column = &columns[kBandColumn * j];
        const double inverse = 1.0 / std::sqrt(column[0]);
        column[0] = inverse;
        for (std::size_t k = 1; k <= kWidth; ++k) column[k] *= inverse;
        for (std::size_t c = 1; c <= kWidth; ++c)
            for (std::size_t k = 0; k + c <= kWidth; ++k) column[kBandColumn * c + k] -= column[c] * column[c + k];
    }
}

void plainSolve(const std::vector<double>& columns, std::size_t rows, std::vector<double>& x)
{
    for (std::size_t j = 0; j < rows; ++j) {
        x[j] *= columns[kBandColumn * j];
        for (std::size_t k = 1; k <= kWidth; ++k) x[j + k] -= x[j] * columns[kBandColumn * j + k];
    }
    std::fill(x.begin() + static_cast<std::ptrdiff_t>(rows), x.end(), 0.0);
    for (std::size_t j = rows; j-- > 0;) {
        for (std::size_t k = 1; k <= kWidth; ++k) x[j] -= columns[kBandColumn * j + k] * x[j + k];
        x[j] *= columns[kBandColumn * j];
    }
}

std::vector<double> plainInverse(const std::vector<double>& columns, std::size_t rows)
{
    std::vector<double> inverse(columns.size());
    for (std::size_t j = rows; j-- > 0;) {
        const double* column = &columns[kBandColumn * j];
        double* out = &inverse[kBandColumn * j];
        double own = column[0] * column[0];
        for (std::size_t row = 1; row <= kWidth; ++row) {
            double sum = 0.0;
            for (std::size_t k = 1; k <= kWidth; ++k) {
                const std::size_t low = std::min(row, k), high = std::max(row, k);
                sum -= column[k] * inverse[kBandColumn * (j + low) + high - low];
            }
            out[row] = sum * column[0];
        }
        for (std::size_t k = 1; k <= kWidth; ++k) own -= column[k] * column[0] * out[k];
        out[0] = own;
    }
    return inverse;
}

PaddedBlock padded(const Mat3& m)
{
    PaddedBlock out;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) out.columns[c][r] = m[r][c];
    return out;
}

} // namespace

TEST_CASE("the kernels of bands give the bits of plain loops on every instruction set")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(5);
        for (const std::size_t rows : {1ul, 3ul, 11ul, 40ul}) {
            CAPTURE(rows);
            std::vector<double> factor = randomBand(rows, random), plain = factor;
            REQUIRE(factoriseBand(factor, rows));
            plainFactor(plain, rows);
            CHECK(factor == plain);
            std::vector<double> x(rows + kBandColumn), other;
            for (std::size_t i = 0; i < rows; ++i) x[i] = std::sin(static_cast<double>(i + 1));
            other = x;
            solveBandForward(factor, rows, x);
            std::fill(x.begin() + static_cast<std::ptrdiff_t>(rows), x.end(), 0.0);
            solveBandBack(factor, rows, x);
            plainSolve(factor, rows, other);
            CHECK(x == other);
            std::vector<double> inverse(factor.size());
            invertBand(factor, rows, inverse);
            CHECK(inverse == plainInverse(factor, rows));
        }
        std::vector<double> refused = randomBand(20, random);
        refused[kBandColumn * 7] = -1.0;
        CHECK_FALSE(factoriseBand(refused, 20));
        refused = randomBand(20, random);
        refused[kBandColumn * 7] = std::numeric_limits<double>::quiet_NaN();
        CHECK_FALSE(factoriseBand(refused, 20));
    });
}

TEST_CASE("outer products give the bits of plain loops on every instruction set, and touch nothing else")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(6);
        std::uniform_real_distribution<double> draw(-1.0, 1.0);
        for (std::size_t count = 0; count <= kMostOuterProducts; ++count) {
            CAPTURE(count);
            std::vector<double> columns = randomBand(14, random), plain = columns;
            double vectors[kMostOuterProducts][kBandEntries];
            std::vector<OuterProduct> terms;
            for (std::size_t t = 0; t < count; ++t) {
                for (double& each : vectors[t]) each = draw(random);
                terms.push_back({draw(random), vectors[t]});
            }
            addOuterProducts(terms, &columns[kBandColumn]);
            for (const OuterProduct& term : terms)
                for (std::size_t c = 0; c < kBandEntries; ++c)
                    for (std::size_t r = c; r < kBandEntries; ++r)
                        plain[kBandColumn * (1 + c) + r - c] += term.factor * term.vector[c] * term.vector[r];
            CHECK(columns == plain);
        }
    });
}

TEST_CASE("the kernels of blocks give the bits of products of matrices on every instruction set")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(7);
        std::uniform_real_distribution<double> draw(-1.0, 1.0);
        const auto vector = [&] { return Vec3{draw(random), draw(random), draw(random)}; };
        std::vector<Mat3> plain(5), targets(4);
        std::vector<PaddedBlock> blocks, into;
        for (Mat3& each : plain) blocks.push_back(padded(each = {{vector(), vector(), vector()}}));
        for (Mat3& each : targets) into.push_back(padded(each = {{vector(), vector(), vector()}}));
        const std::vector<int> rows{2, 0, 4};
        const std::vector<std::size_t> places{3, 9, 0, 9, 1};
        subtractProducts(std::span(blocks).first(3), rows.data(), places.data(), into.data());
        for (std::size_t k = 0; k < rows.size(); ++k)
            targets[places[static_cast<std::size_t>(rows[k])]] -= plain[k] * transpose(plain[0]);
        for (std::size_t i = 0; i < into.size(); ++i) CHECK(into[i].matrix() == targets[i]);
        multiplyBlocks(std::span(blocks).first(3), blocks[4]);
        for (std::size_t k = 0; k < 3; ++k) CHECK(blocks[k].matrix() == plain[k] * transpose(plain[4]));

        // Two columns: the first with a block in the row of the second.
        const std::vector<std::size_t> first{0, 2, 3};
        const std::vector<int> rowOf{0, 1, 1};
        const Vec3 a = vector(), b = vector();
        std::vector<PaddedVector> x{{{a.x, a.y, a.z}}, {{b.x, b.y, b.z}}};
        solveBlocksForward(2, first.data(), rowOf.data(), blocks.data(), x.data());
        const Vec3 top = blocks[0].matrix() * a, low = blocks[2].matrix() * (b - blocks[1].matrix() * top);
        CHECK(Vec3{x[0].entries[0], x[0].entries[1], x[0].entries[2]} == top);
        CHECK(Vec3{x[1].entries[0], x[1].entries[1], x[1].entries[2]} == low);
    });
}

} // namespace factor_kernels_test
