#include "filasofia/linalg/factor_kernels.h"

#include "filasofia/linalg/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filasofia/linalg/factor_kernels.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace filasofia::linalg::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, 4>;
using D = hn::Vec<Doubles>;
constexpr std::size_t kDoubles = hn::MaxLanes(Doubles());

/// A column of a band, with zeros behind it: a part of it may be read from any of its entries on.
struct LongColumn {
    double entries[2 * kBandColumn] = {};
};

HWY_ATTR bool factoriseBandColumns(double* HWY_RESTRICT columns, std::size_t rows)
{
    const Doubles d;
    LongColumn whole;
    double* own = whole.entries;
    for (std::size_t j = 0; j < rows; ++j) {
        double* column = columns + kBandColumn * j;
        if (!(column[0] > 0.0) || !std::isfinite(column[0])) return false;
        const double inverse = 1.0 / std::sqrt(column[0]);
        for (std::size_t k = 0; k < kBandEntries; ++k) column[k] = own[k] = column[k] * inverse;
        column[0] = inverse;
        for (std::size_t c = 1; c < kBandEntries; ++c) { // what the columns to the right lose
            double* right = columns + kBandColumn * (j + c);
            const D factor = hn::Set(d, own[c]);
            for (std::size_t k = 0; k + c < kBandEntries; k += kDoubles)
                hn::StoreU(hn::Sub(hn::LoadU(d, right + k), hn::Mul(factor, hn::LoadU(d, own + c + k))), d, right + k);
        }
    }
    return true;
}

HWY_ATTR void solveForward(const double* HWY_RESTRICT columns, std::size_t rows, double* HWY_RESTRICT x)
{
    const Doubles d;
    for (std::size_t j = 0; j < rows; ++j) {
        const double* column = columns + kBandColumn * j;
        double* at = x + j;
        const double known = at[0] * column[0];
        const D factor = hn::Set(d, known);
        for (std::size_t k = 0; k < kBandColumn; k += kDoubles)
            hn::StoreU(hn::Sub(hn::LoadU(d, at + k), hn::Mul(factor, hn::LoadU(d, column + k))), d, at + k);
        at[0] = known;
    }
}

/// With U = L D^-1, whose diagonal is 1: A^-1 = D^-2 U^-1 + (1 - U^T) A^-1, of which the lower half needs no U^-1.
HWY_ATTR void invert(const double* HWY_RESTRICT columns, std::size_t rows, double* HWY_RESTRICT inverse)
{
    const Doubles d;
    constexpr std::size_t kKept = 16, kWhole = 2 * kBandColumn; // the last columns, both halves of them, in turns
    static_assert(kKept >= kBandEntries);
    double kept[kKept][kWhole] = {};
    constexpr std::size_t kMiddle = kBandEntries - 1; // where the diagonal is
    for (std::size_t j = rows; j-- > 0;) {
        const double* column = columns + kBandColumn * j;
        double* out = inverse + kBandColumn * j;
        double sums[kBandColumn] = {};
        for (std::size_t k = 1; k < kBandEntries; ++k) {
            const double* from = kept[(j + k) % kKept] + kMiddle + 1 - k; // from the row of j + 1 on
            const D factor = hn::Set(d, column[k]);
            for (std::size_t row = 0; row < kBandColumn; row += kDoubles)
                hn::StoreU(hn::Sub(hn::LoadU(d, sums + row), hn::Mul(factor, hn::LoadU(d, from + row))), d, sums + row);
        }
        double* whole = kept[j % kKept];
        for (std::size_t k = 0; k < kWhole; ++k) whole[k] = 0.0;
        double own = column[0] * column[0];
        for (std::size_t k = 1; k < kBandEntries; ++k) {
            out[k] = sums[k - 1] * column[0];
            own -= column[k] * column[0] * out[k];
            whole[kMiddle + k] = out[k];
            kept[(j + k) % kKept][kMiddle - k] = out[k];
        }
        out[0] = whole[kMiddle] = own;
    }
}

HWY_ATTR void addOuter(const OuterProduct* terms, std::size_t count, double* HWY_RESTRICT columns)
{
    const Doubles d;
    LongColumn vectors[kMostOuterProducts];
    for (std::size_t t = 0; t < count; ++t)
        for (std::size_t k = 0; k < kBandEntries; ++k) vectors[t].entries[k] = terms[t].vector[k];
    for (std::size_t c = 0; c < kBandEntries; ++c) {
        double* column = columns + kBandColumn * c;
        double factors[kMostOuterProducts];
        for (std::size_t t = 0; t < count; ++t) factors[t] = terms[t].factor * vectors[t].entries[c];
        for (std::size_t k = 0; k + c < kBandEntries; k += kDoubles) {
            D sum = hn::LoadU(d, column + k);
            for (std::size_t t = 0; t < count; ++t)
                sum = hn::Add(sum, hn::Mul(hn::Set(d, factors[t]), hn::LoadU(d, vectors[t].entries + c + k)));
            hn::StoreU(sum, d, column + k);
        }
    }
}

/// (a b^T) with b's entries given one by one: part of a column.
struct Factor {
    D entries[3][3]; ///< [i][j]: row j, column i
    HWY_INLINE explicit Factor(const PaddedBlock& block)
    {
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) entries[i][j] = hn::Set(Doubles(), block.columns[i][j]);
    }
    HWY_INLINE D column(const D (&a)[3], std::size_t j) const
    {
        return hn::Add(hn::Add(hn::Mul(a[0], entries[0][j]), hn::Mul(a[1], entries[1][j])),
                       hn::Mul(a[2], entries[2][j]));
    }
};

HWY_ATTR void subtract(const PaddedBlock* HWY_RESTRICT factors, std::size_t count, const int* HWY_RESTRICT rows,
                       const std::size_t* HWY_RESTRICT places, PaddedBlock* HWY_RESTRICT targets)
{
    const Doubles d;
    const Factor factor(factors[0]);
    for (std::size_t k = 0; k < count; ++k) {
        PaddedBlock& target = targets[places[rows[k]]];
        for (std::size_t part = 0; part < 4; part += kDoubles) {
            const D a[3] = {hn::Load(d, factors[k].columns[0] + part), hn::Load(d, factors[k].columns[1] + part),
                            hn::Load(d, factors[k].columns[2] + part)};
            for (std::size_t j = 0; j < 3; ++j) {
                double* column = target.columns[j] + part;
                hn::Store(hn::Sub(hn::Load(d, column), factor.column(a, j)), d, column);
            }
        }
    }
}

HWY_ATTR void multiply(PaddedBlock* HWY_RESTRICT blocks, std::size_t count, const PaddedBlock& by)
{
    const Doubles d;
    const Factor factor(by);
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t part = 0; part < 4; part += kDoubles) {
            const D a[3] = {hn::Load(d, blocks[k].columns[0] + part), hn::Load(d, blocks[k].columns[1] + part),
                            hn::Load(d, blocks[k].columns[2] + part)};
            for (std::size_t j = 0; j < 3; ++j) hn::Store(factor.column(a, j), d, blocks[k].columns[j] + part);
        }
}

HWY_ATTR void solveForwardBlocks(std::size_t columns, const std::size_t* HWY_RESTRICT first,
                                 const int* HWY_RESTRICT rows, const PaddedBlock* HWY_RESTRICT blocks,
                                 PaddedVector* HWY_RESTRICT x)
{
    const Doubles d;
    const auto times = [&](const PaddedBlock& block, const D(&v)[3], std::size_t part) HWY_ATTR {
        return hn::Add(hn::Add(hn::Mul(hn::Load(d, block.columns[0] + part), v[0]),
                               hn::Mul(hn::Load(d, block.columns[1] + part), v[1])),
                       hn::Mul(hn::Load(d, block.columns[2] + part), v[2]));
    };
    for (std::size_t column = 0; column < columns; ++column) {
        double* here = x[column].entries;
        const D before[3] = {hn::Set(d, here[0]), hn::Set(d, here[1]), hn::Set(d, here[2])};
        for (std::size_t part = 0; part < 4; part += kDoubles)
            hn::Store(times(blocks[first[column]], before, part), d, here + part);
        const D now[3] = {hn::Set(d, here[0]), hn::Set(d, here[1]), hn::Set(d, here[2])};
        for (std::size_t k = first[column] + 1; k < first[column + 1]; ++k)
            for (std::size_t part = 0; part < 4; part += kDoubles) {
                double* at = x[rows[k]].entries + part;
                hn::Store(hn::Sub(hn::Load(d, at), times(blocks[k], now, part)), d, at);
            }
    }
}

} // namespace filasofia::linalg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace filasofia::linalg {

HWY_EXPORT(factoriseBandColumns);
HWY_EXPORT(solveForward);
HWY_EXPORT(invert);
HWY_EXPORT(addOuter);
HWY_EXPORT(subtract);
HWY_EXPORT(multiply);
HWY_EXPORT(solveForwardBlocks);

bool factoriseBand(std::span<double> columns, std::size_t rows)
{
    return HWY_DYNAMIC_DISPATCH(factoriseBandColumns)(columns.data(), rows);
}

void solveBandForward(std::span<const double> columns, std::size_t rows, std::span<double> x)
{
    HWY_DYNAMIC_DISPATCH(solveForward)(columns.data(), rows, x.data());
}

void solveBandBack(std::span<const double> columns, std::size_t rows, std::span<double> x)
{
    for (std::size_t j = rows; j-- > 0;) { // a sum after the other: nothing to gain from vectors
        const double *column = &columns[kBandColumn * j], *at = &x[j];
        double sum = at[0];
        for (std::size_t k = 1; k < kBandEntries; ++k) sum -= column[k] * at[k];
        x[j] = sum * column[0];
    }
}

void invertBand(std::span<const double> columns, std::size_t rows, std::span<double> inverse)
{
    HWY_DYNAMIC_DISPATCH(invert)(columns.data(), rows, inverse.data());
}

void addOuterProducts(std::span<const OuterProduct> terms, double* columns)
{
    HWY_DYNAMIC_DISPATCH(addOuter)(terms.data(), terms.size(), columns);
}

void subtractProducts(std::span<const PaddedBlock> factors, const int* rows, const std::size_t* places,
                      PaddedBlock* targets)
{
    HWY_DYNAMIC_DISPATCH(subtract)(factors.data(), factors.size(), rows, places, targets);
}

void multiplyBlocks(std::span<PaddedBlock> blocks, const PaddedBlock& factor)
{
    HWY_DYNAMIC_DISPATCH(multiply)(blocks.data(), blocks.size(), factor);
}

void solveBlocksForward(std::size_t columns, const std::size_t* first, const int* rows, const PaddedBlock* blocks,
                        PaddedVector* x)
{
    HWY_DYNAMIC_DISPATCH(solveForwardBlocks)(columns, first, rows, blocks, x);
}

} // namespace filasofia::linalg
#endif
