#pragma once

#include "filasofia/math/mat3.h"

#include <cstddef>
#include <span>

/// The inner loops of the factorisations in double: of a band (BandCholesky), and of a sparse matrix of 3x3 blocks
/// (BlockCholesky). They are vectorised (Highway), for the best instruction set of the machine, which is chosen at run
/// time. None fuses a multiplication with an addition, and every entry sums up in the same order: every instruction set
/// gives the same bits.
namespace filasofia::linalg {

/// A column of a band: the diagonal, ten entries below it, and a zero, so that it fills whole vectors.
inline constexpr std::size_t kBandEntries = 11, kBandColumn = 12;

/// All of these have kBandEntries - 1 columns of zeros after the last one, so that no loop needs a bound.
/// A = L L^T, in place, but on the diagonal the inverse of L's entries. Returns false if a pivot is not positive.
bool factoriseBand(std::span<double> columns, std::size_t rows);
/// x = L^-1 x; `x` has kBandColumn numbers more than rows, which are scratch.
void solveBandForward(std::span<const double> columns, std::size_t rows, std::span<double> x);
/// x = L^-T x, of which the numbers after the last row are zero.
void solveBandBack(std::span<const double> columns, std::size_t rows, std::span<double> x);
/// The entries of A^-1 within the band, from L (Takahashi, Fagan and Chen 1973).
void invertBand(std::span<const double> columns, std::size_t rows, std::span<double> inverse);

/// A term of a sum: factor * vector vector^T.
struct OuterProduct {
    double factor = 0.0;
    const double* vector = nullptr; ///< kBandEntries numbers
};
inline constexpr std::size_t kMostOuterProducts = 6;
/// Adds at most so many of them to the kBandEntries columns from `columns` on.
void addOuterProducts(std::span<const OuterProduct> terms, double* columns);

/// A 3x3 block by columns, each with a zero, so that it fills whole vectors.
struct alignas(32) PaddedBlock {
    double columns[3][4] = {};
    [[nodiscard]] Mat3 matrix() const
    {
        const auto column = [&](int c) { return Vec3{columns[c][0], columns[c][1], columns[c][2]}; };
        return Mat3::columns(column(0), column(1), column(2));
    }
};
struct alignas(32) PaddedVector {
    double entries[4] = {};
};

/// targets[places[rows[k]]] -= factors[k] factors[0]^T for all k.
void subtractProducts(std::span<const PaddedBlock> factors, const int* rows, const std::size_t* places,
                      PaddedBlock* targets);
/// blocks[k] = blocks[k] factor^T
void multiplyBlocks(std::span<PaddedBlock> blocks, const PaddedBlock& factor);
/// The lower factor L by columns, with the inverse of each block on the diagonal: x = L^-1 x, of so many blocks.
/// `first`: per column its first block, on the diagonal; last, the number of all blocks. `rows`: per block.
void solveBlocksForward(std::size_t columns, const std::size_t* first, const int* rows, const PaddedBlock* blocks,
                        PaddedVector* x);

} // namespace filasofia::linalg
