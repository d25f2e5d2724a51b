#pragma once

#include "filasofia/linalg/factor_kernels.h"

#include <cstddef>
#include <span>
#include <vector>

namespace filasofia::linalg {

/// A sparse symmetric positive definite matrix of 3x3 blocks, factorised: Q A Q^T = L L^T. The order Q keeps L sparse
/// (approximate minimum degree, Amestoy et al. 1996); L is computed column by column, each from those to its left
/// (Davis 2006, chapter 4).
class BlockCholesky {
public:
    struct Place {
        int row = 0, column = 0;
        friend bool operator==(const Place&, const Place&) = default;
    };

    /// The places of the blocks of the lower half of a matrix of n rows of blocks, in any order, every one on the
    /// diagonal among them; a place may appear more than once.
    void analyse(std::span<const Place> lower, int n);
    /// The blocks at these places; those of one place are added up, and those of the diagonal are symmetric. Returns
    /// false if the matrix is not positive definite to rounding; solve() must not be called then.
    bool factorise(std::span<const Mat3> lower);
    void solve(std::span<Vec3> x) const; ///< x = A^-1 x; x has n vectors

private:
    /// Per row of A, the columns of its blocks in both halves, that of the diagonal first.
    struct Neighbours {
        std::vector<std::size_t> first; ///< last, the total number
        std::vector<int> list;
    };
    /// Where a block of A goes.
    struct Target {
        std::size_t block = 0; ///< in L
        bool turned = false;   ///< the transposed block is in the lower half of Q A Q^T
    };

    static Neighbours neighboursOf(std::span<const Place> lower, int n);
    void order(const Neighbours& neighbours);
    void findColumns(const Neighbours& neighbours);
    void findBlocks();
    [[nodiscard]] std::size_t begin(int column) const { return first_[static_cast<std::size_t>(column)]; }
    [[nodiscard]] std::size_t end(int column) const { return first_[static_cast<std::size_t>(column) + 1]; }

    std::vector<Place> places_;
    std::vector<int> placeOf_, rowAt_; ///< per row of A: its row in Q A Q^T; and back
    std::vector<Target> targets_;      ///< per place
    std::vector<std::size_t> first_;   ///< per column of L: its first block, on the diagonal; last, the total number
    std::vector<int> rows_;            ///< per block of L; ascending in each column
    std::vector<PaddedBlock> blocks_;  ///< L, but L^-1 on the diagonal
    std::vector<std::size_t> blockAt_; ///< scratch: per row, its block in the column that is being computed
    std::vector<int> waiting_, next_;  ///< scratch: per row, a list of the columns that its column takes next
    std::vector<std::size_t> reached_; ///< scratch: per column, its block in that row
    mutable std::vector<PaddedVector> solution_; ///< scratch, in the order Q
};

} // namespace filasofia::linalg
