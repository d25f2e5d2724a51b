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
bool invertFactor(PaddedBlock& replaced, double largest)
{
    const Mat3 block = replaced.matrix();
    const double smallest = std::numeric_limits<double>::epsilon() * largest;
    const auto root = [&](double pivot) { return pivot > smallest ? std::sqrt(pivot) : 0.0; };
    const double a = root(block[0].x);
    if (!(a > 0.0)) return false;
    const double b = block[1].x / a, d = block[2].x / a, c = root(block[1].y - b * b);
    if (!(c > 0.0)) return false;
    const double e = (block[2].y - d * b) / c, f = root(block[2].z - d * d - e * e);
    if (!(f > 0.0) || !std::isfinite(a + c + f)) return false;
    replaced = {
        {{1.0 / a, -b / (a * c), (b * e - d * c) / (a * c * f)}, {0.0, 1.0 / c, -e / (c * f)}, {0.0, 0.0, 1.0 / f}}};
    return true;
}

double largestOnDiagonal(const PaddedBlock& block)
{
    return std::max({block.columns[0][0], block.columns[1][1], block.columns[2][2]});
}

/// block += m, or its transpose
void add(const Mat3& m, bool transposed, PaddedBlock& block)
{
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) block.columns[c][r] += transposed ? m[c][r] : m[r][c];
}

/// block^T v
Vec3 transposeTimes(const PaddedBlock& block, const PaddedVector& v)
{
    const auto column = [&](int c) {
        const double* a = block.columns[c];
        return v.entries[0] * a[0] + v.entries[1] * a[1] + v.entries[2] * a[2];
    };
    return {column(0), column(1), column(2)};
}

Vec3 vectorOf(const PaddedVector& v) { return {v.entries[0], v.entries[1], v.entries[2]}; }
PaddedVector padded(Vec3 v) { return {{v.x, v.y, v.z}}; }

} // namespace

bool BlockCholesky::factorise(std::span<const Mat3> lower)
{
    const int n = static_cast<int>(placeOf_.size());
    std::ranges::fill(blocks_, PaddedBlock{});
    for (std::size_t k = 0; k < lower.size(); ++k) add(lower[k], targets_[k].turned, blocks_[targets_[k].block]);
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
            subtractProducts({&blocks_[from], end(left) - from}, &rows_[from], blockAt_.data(), blocks_.data());
            wait(left, from + 1);
        }
        if (!invertFactor(blocks_[begin(column)], largest)) return false;
        multiplyBlocks(std::span(blocks_).subspan(begin(column) + 1, end(column) - begin(column) - 1),
                       blocks_[begin(column)]);
        wait(column, begin(column) + 1);
    }
    return true;
}

void BlockCholesky::solve(std::span<Vec3> x) const
{
    const int n = static_cast<int>(x.size());
    solution_.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) solution_[at(placeOf_[i])] = padded(x[i]);
    solveBlocksForward(x.size(), first_.data(), rows_.data(), blocks_.data(), solution_.data());
    for (int column = n - 1; column >= 0; --column) {
        Vec3 here = vectorOf(solution_[at(column)]);
        for (std::size_t k = begin(column) + 1; k < end(column); ++k)
            here -= transposeTimes(blocks_[k], solution_[at(rows_[k])]);
        solution_[at(column)] = padded(transposeTimes(blocks_[begin(column)], padded(here)));
    }
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = vectorOf(solution_[at(placeOf_[i])]);
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
