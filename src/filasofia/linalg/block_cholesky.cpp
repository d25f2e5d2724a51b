#include "filasofia/linalg/block_cholesky.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace filasofia::linalg {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Replaces a symmetric block by the inverse of its lower Cholesky factor. Returns false if it has none to rounding;
/// `largest` is the largest diagonal entry before other columns were subtracted.
bool invertFactor(Mat3& block, double largest)
{
    const double smallest = std::numeric_limits<double>::epsilon() * largest;
    const auto root = [&](double pivot) { return pivot > smallest ? std::sqrt(pivot) : 0.0; };
    const double a = root(block[0].x);
    if (!(a > 0.0)) return false;
    const double b = block[1].x / a, d = block[2].x / a, c = root(block[1].y - b * b);
    if (!(c > 0.0)) return false;
    const double e = (block[2].y - d * b) / c, f = root(block[2].z - d * d - e * e);
    if (!(f > 0.0) || !std::isfinite(a + c + f)) return false;
    block = {
        {{1.0 / a, 0.0, 0.0}, {-b / (a * c), 1.0 / c, 0.0}, {(b * e - d * c) / (a * c * f), -e / (c * f), 1.0 / f}}};
    return true;
}

double largestOnDiagonal(const Mat3& block) { return std::max({block[0].x, block[1].y, block[2].z}); }

} // namespace

bool BlockCholesky::factorise(std::span<const Mat3> lower)
{
    const int n = static_cast<int>(placeOf_.size());
    std::ranges::fill(blocks_, Mat3{});
    for (std::size_t k = 0; k < lower.size(); ++k)
        blocks_[targets_[k].block] += targets_[k].turned ? transpose(lower[k]) : lower[k];
    std::ranges::fill(waiting_, -1);
    const auto wait = [&](int column, std::size_t block) {
        if (block == end(column)) return;
        int& head = waiting_[at(rows_[block])];
        reached_[at(column)] = block;
        next_[at(column)] = head;
        head = column;
    };
    for (int column = 0; column < n; ++column) {
        for (std::size_t k = begin(column); k < end(column); ++k) blockAt_[at(rows_[k])] = k;
        const double largest = largestOnDiagonal(blocks_[begin(column)]);
        for (int left = waiting_[at(column)], after = -1; left >= 0; left = after) {
            after = next_[at(left)];
            const std::size_t from = reached_[at(left)];
            const Mat3 factor = transpose(blocks_[from]);
            for (std::size_t k = from; k < end(left); ++k) blocks_[blockAt_[at(rows_[k])]] -= blocks_[k] * factor;
            wait(left, from + 1);
        }
        if (!invertFactor(blocks_[begin(column)], largest)) return false;
        const Mat3 inverse = transpose(blocks_[begin(column)]);
        for (std::size_t k = begin(column) + 1; k < end(column); ++k) blocks_[k] = blocks_[k] * inverse;
        wait(column, begin(column) + 1);
    }
    return true;
}

void BlockCholesky::solve(std::span<Vec3> x) const
{
    const int n = static_cast<int>(x.size());
    solution_.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) solution_[at(placeOf_[i])] = x[i];
    for (int column = 0; column < n; ++column) {
        Vec3& here = solution_[at(column)];
        here = blocks_[begin(column)] * here;
        for (std::size_t k = begin(column) + 1; k < end(column); ++k) solution_[at(rows_[k])] -= blocks_[k] * here;
    }
    for (int column = n - 1; column >= 0; --column) {
        Vec3& here = solution_[at(column)];
        for (std::size_t k = begin(column) + 1; k < end(column); ++k)
            here -= transposeTimes(blocks_[k], solution_[at(rows_[k])]);
        here = transposeTimes(blocks_[begin(column)], here);
    }
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = solution_[at(placeOf_[i])];
}

void BlockCholesky::analyse(std::span<const Place> lower, int n)
{
    if (placeOf_.size() == at(n) && std::ranges::equal(lower, places_)) return; // the order is kept
    places_.assign(lower.begin(), lower.end());
    const Neighbours neighbours = neighboursOf(lower, n);
    order(neighbours);
    findColumns(neighbours);
    findBlocks();
    blockAt_.resize(at(n));
    for (std::vector<int>* each : {&waiting_, &next_}) each->resize(at(n));
    reached_.resize(at(n));
}

BlockCholesky::Neighbours BlockCholesky::neighboursOf(std::span<const Place> lower, int n)
{
    Neighbours all; // with those that appear more than once
    std::vector<std::size_t> next(at(n) + 1);
    for (const auto& [row, column] : lower) {
        if (row == column) continue;
        ++next[at(row) + 1];
        ++next[at(column) + 1];
    }
    std::partial_sum(next.begin(), next.end(), next.begin());
    all.first = next;
    all.list.resize(all.first.back());
    for (const auto& [row, column] : lower) {
        if (row == column) continue;
        all.list[next[at(row)]++] = column;
        all.list[next[at(column)]++] = row;
    }
    Neighbours out;
    out.first.push_back(0);
    std::vector<int> seenBy(at(n), -1);
    for (int row = 0; row < n; ++row) {
        out.list.push_back(row); // Eigen's ordering puts rows without a diagonal last
        for (std::size_t k = all.first[at(row)]; k < all.first[at(row) + 1]; ++k)
            if (std::exchange(seenBy[at(all.list[k])], row) != row) out.list.push_back(all.list[k]);
        out.first.push_back(out.list.size());
    }
    return out;
}

void BlockCholesky::order(const Neighbours& neighbours)
{
    const int n = static_cast<int>(neighbours.first.size()) - 1;
    Eigen::SparseMatrix<double> matrix(n, n); // its values do not matter
    matrix.resizeNonZeros(static_cast<Eigen::Index>(neighbours.list.size()));
    std::ranges::transform(neighbours.first, matrix.outerIndexPtr(), [](std::size_t k) { return static_cast<int>(k); });
    std::ranges::copy(neighbours.list, matrix.innerIndexPtr());
    std::fill_n(matrix.valuePtr(), neighbours.list.size(), 1.0);
    Eigen::AMDOrdering<int>::PermutationType permutation;
    Eigen::AMDOrdering<int>()(matrix, permutation);
    rowAt_.assign(permutation.indices().data(), permutation.indices().data() + n);
    placeOf_.resize(at(n));
    for (int place = 0; place < n; ++place) placeOf_[at(rowAt_[at(place)])] = place;
}

/// A column of L has a block wherever Q A Q^T has one, or a column to its left whose second block is in this column's
/// row.
void BlockCholesky::findColumns(const Neighbours& neighbours)
{
    const int n = static_cast<int>(rowAt_.size());
    std::vector<int> firstChild(at(n), -1), sibling(at(n), -1), seenBy(at(n), -1);
    first_.assign(1, 0);
    rows_.clear();
    for (int column = 0; column < n; ++column) {
        const auto add = [&](int row) {
            if (row >= column && std::exchange(seenBy[at(row)], column) != column) rows_.push_back(row);
        };
        add(column);
        const int row = rowAt_[at(column)];
        for (std::size_t k = neighbours.first[at(row)]; k < neighbours.first[at(row) + 1]; ++k)
            add(placeOf_[at(neighbours.list[k])]);
        for (int child = firstChild[at(column)]; child >= 0; child = sibling[at(child)])
            for (std::size_t k = begin(child) + 1; k < end(child); ++k) add(rows_[k]);
        std::sort(rows_.begin() + static_cast<std::ptrdiff_t>(first_.back()), rows_.end());
        if (rows_.size() > first_.back() + 1)
            sibling[at(column)] = std::exchange(firstChild[at(rows_[first_.back() + 1])], column);
        first_.push_back(rows_.size());
    }
    blocks_.resize(rows_.size());
}

void BlockCholesky::findBlocks()
{
    targets_.clear();
    for (const auto& [row, column] : places_) {
        const int a = placeOf_[at(row)], b = placeOf_[at(column)], left = std::min(a, b);
        const auto from = rows_.begin() + static_cast<std::ptrdiff_t>(begin(left)),
                   to = rows_.begin() + static_cast<std::ptrdiff_t>(end(left));
        targets_.push_back(
            {static_cast<std::size_t>(std::lower_bound(from, to, std::max(a, b)) - rows_.begin()), a < b});
    }
}

} // namespace filasofia::linalg
