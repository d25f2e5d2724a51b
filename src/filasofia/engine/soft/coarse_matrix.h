#pragma once

#include "filasofia/geometry/coarse_lattice.h"
#include "filasofia/linalg/small_pieces.h"

#include <cstddef>
#include <span>
#include <vector>

namespace filasofia::engine {

/// A short sparse vector over coarse nodes: P^T applied to the values of a few nodes.
template <class Value> class CoarseSum {
public:
    void clear() { count_ = 0; }
    void add(const geometry::CoarseLattice& lattice, std::size_t node, const Value& value)
    {
        for (std::size_t k = 0; k < 4; ++k) {
            const double weight = static_cast<double>(lattice.weights[node][k]);
            if (weight == 0.0) continue;
            const int corner = lattice.corners[node][k];
            std::size_t at = 0;
            while (at < count_ && corners_[at] != corner) ++at;
            if (at == corners_.size()) {
                corners_.emplace_back();
                values_.emplace_back();
            }
            if (at == count_) {
                corners_[count_] = corner;
                values_[count_++] = {};
            }
            values_[at] += weight * value;
        }
    }
    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] int corner(std::size_t i) const { return corners_[i]; }
    [[nodiscard]] const Value& value(std::size_t i) const { return values_[i]; }

private:
    std::size_t count_ = 0;
    std::vector<int> corners_; // with room for later sums
    std::vector<Value> values_;
};

/// The coarse matrix A_c = P^T A P, row by row: one dense matrix of the lattice, and one per small piece.
class CoarseMatrix {
public:
    explicit CoarseMatrix(const geometry::CoarseLattice& lattice)
        : nodes_(lattice.nodeCount), lattice_(9 * static_cast<std::size_t>(nodes_) * static_cast<std::size_t>(nodes_)),
          pieces_(lattice.pieces.size() * kPieceUnknowns * kPieceUnknowns)
    {
    }

    /// The 3 x 3 block of two coarse nodes of the same matrix.
    struct Block {
        double* at;
        std::size_t next; ///< offset from one row to the next
        void add(std::size_t row, std::size_t column, double value) const { at[row * next + column] += value; }
    };
    Block block(int row, int column)
    {
        if (row < nodes_) return blockOf(lattice_.data(), 3 * static_cast<std::size_t>(nodes_), row, column);
        const int piece = linalg::pieceOfNode(row, nodes_);
        const int first = linalg::firstPieceNode(nodes_) + piece * linalg::kPieceNodes;
        return blockOf(pieces_.data() + static_cast<std::size_t>(piece) * kPieceUnknowns * kPieceUnknowns,
                       kPieceUnknowns, row - first, column - first);
    }
    /// Whether two coarse nodes belong to the same matrix.
    [[nodiscard]] bool together(int row, int column) const
    {
        return linalg::pieceOfNode(row, nodes_) == linalg::pieceOfNode(column, nodes_);
    }
    [[nodiscard]] std::span<const double> lattice() const { return lattice_; }
    [[nodiscard]] std::span<const double> pieces() const { return pieces_; }

private:
    static constexpr std::size_t kPieceUnknowns = linalg::kPieceUnknowns;
    static Block blockOf(double* matrix, std::size_t unknowns, int row, int column)
    {
        return {matrix + 3 * (static_cast<std::size_t>(row) * unknowns + static_cast<std::size_t>(column)), unknowns};
    }
    int nodes_;
    std::vector<double> lattice_, pieces_;
};

/// Calls add(block, a, b) for each pair of coarse nodes of a sum in the lower half of their matrix. Two coarse nodes
/// without a common matrix are left out: a node held between two small pieces takes part in both.
template <class Value, class Add> void forEachPair(const CoarseSum<Value>& sum, CoarseMatrix& matrix, const Add& add)
{
    for (std::size_t i = 0; i < sum.count(); ++i)
        for (std::size_t j = 0; j < sum.count(); ++j)
            if (sum.corner(j) <= sum.corner(i) && matrix.together(sum.corner(i), sum.corner(j)))
                add(matrix.block(sum.corner(i), sum.corner(j)), sum.value(i), sum.value(j));
}

} // namespace filasofia::engine
