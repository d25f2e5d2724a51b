#include "filasofia/sofa/compliant_factor.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace filasofia::sofaengine {
namespace {

constexpr std::size_t kLanes = 8; // right sides that are solved for together

/// A row of J: which of the numbers it reads, and by how much.
struct Row {
    int row = 0;
    std::vector<std::pair<int, double>> entries = {};
};

/// L^-1 applied to eight columns, of which few numbers differ from 0.
struct Solved {
    std::vector<double> x = {};    ///< [n][kLanes]
    std::vector<int> reached = {}; ///< numbers that differ from 0 in any lane, ascending
};

/// A unit in each lane; `at`: where, ascending, at most kLanes.
template <class Data> Solved solveLower(const Data& factor, const int* at, std::size_t count)
{
    Solved solved{.x = std::vector<double>(static_cast<std::size_t>(factor.n) * kLanes)};
    for (std::size_t lane = 0; lane < count; ++lane) solved.x[static_cast<std::size_t>(at[lane]) * kLanes + lane] = 1.0;
    for (int k = at[0]; k < factor.n; ++k) {
        std::array<double, kLanes> own;
        std::copy_n(&solved.x[static_cast<std::size_t>(k) * kLanes], kLanes, own.begin());
        if (std::ranges::all_of(own, [](double each) { return each == 0.0; })) continue;
        solved.reached.push_back(k);
        for (int p = factor.L_colptr[k]; p < factor.L_colptr[k + 1]; ++p) {
            double* other = &solved.x[static_cast<std::size_t>(factor.L_rowind[p]) * kLanes];
            const double l = factor.L_values[p];
            for (std::size_t lane = 0; lane < kLanes; ++lane) other[lane] -= l * own[lane];
        }
    }
    return solved;
}

/// The products of all columns of two blocks, weighted by D^-1.
template <class Data> std::array<double, kLanes * kLanes> product(const Data& factor, const Solved& a, const Solved& b)
{
    std::array<double, kLanes * kLanes> sum{};
    for (const int k : a.reached) {
        const double* first = &a.x[static_cast<std::size_t>(k) * kLanes];
        const double* second = &b.x[static_cast<std::size_t>(k) * kLanes];
        for (std::size_t i = 0; i < kLanes; ++i) {
            const double weighted = first[i] * factor.invD[k];
            for (std::size_t j = 0; j < kLanes; ++j) sum[i * kLanes + j] += weighted * second[j];
        }
    }
    return sum;
}

/// E^T A^-1 E for units at these numbers of the permuted matrix, ascending: a dense symmetric matrix.
template <class Data> std::vector<double> complianceOf(const Data& factor, const std::vector<int>& at)
{
    std::vector<Solved> blocks;
    for (std::size_t first = 0; first < at.size(); first += kLanes)
        blocks.push_back(solveLower(factor, &at[first], std::min(kLanes, at.size() - first)));
    std::vector<double> dense(at.size() * at.size());
    for (std::size_t a = 0; a < blocks.size(); ++a)
        for (std::size_t b = a; b < blocks.size(); ++b) {
            // A path from a higher number is a part of one from a lower number, or meets it later: b reaches less.
            const auto sum = product(factor, blocks[b], blocks[a]);
            for (std::size_t i = 0; i < kLanes; ++i)
                for (std::size_t j = 0; j < kLanes; ++j) {
                    const std::size_t row = b * kLanes + i, column = a * kLanes + j;
                    if (row >= at.size() || column >= at.size()) continue;
                    dense[row * at.size() + column] = dense[column * at.size() + row] = sum[i * kLanes + j];
                }
        }
    return dense;
}

/// The numbers of the factor that J reads, ascending, and its rows by their places in that list.
template <class Data, class Jacobian>
std::vector<Row> rowsOf(const Data& factor, const Jacobian& jacobian, std::vector<int>& numbers)
{
    for (auto row = jacobian.begin(); row != jacobian.end(); ++row)
        for (const auto& entry : row->second) numbers.push_back(factor.invperm[entry.first]);
    std::ranges::sort(numbers);
    numbers.erase(std::ranges::unique(numbers).begin(), numbers.end());
    std::vector<Row> rows;
    for (auto row = jacobian.begin(); row != jacobian.end(); ++row) {
        Row& fresh = rows.emplace_back(Row{.row = static_cast<int>(row->first)});
        for (const auto& [column, value] : row->second) {
            const auto at = std::ranges::lower_bound(numbers, factor.invperm[column]);
            fresh.entries.emplace_back(static_cast<int>(at - numbers.begin()), value);
        }
    }
    return rows;
}

} // namespace

bool CompliantFactor::addJMInvJtLocal(Blocks* matrix, ResMatrixType* result, const JMatrixType* jacobian, SReal factor)
{
    if (!this->isComponentStateValid() || jacobian->rowSize() == 0) return true;
    const auto& data = *static_cast<InvertData*>(this->getMatrixInvertData(matrix));
    std::vector<int> numbers;
    const std::vector<Row> rows = rowsOf(data, *jacobian, numbers);
    if (numbers.empty()) return true;
    const std::vector<double> dense = complianceOf(data, numbers);
    std::vector<double> moved(numbers.size());
    for (std::size_t r = 0; r < rows.size(); ++r) {
        std::ranges::fill(moved, 0.0);
        for (const auto& [at, value] : rows[r].entries)
            for (std::size_t c = 0; c < numbers.size(); ++c)
                moved[c] += value * dense[static_cast<std::size_t>(at) * numbers.size() + c];
        for (std::size_t s = 0; s <= r; ++s) {
            double sum = 0.0;
            for (const auto& [at, value] : rows[s].entries) sum += value * moved[static_cast<std::size_t>(at)];
            result->add(rows[r].row, rows[s].row, sum * factor);
            if (s != r) result->add(rows[s].row, rows[r].row, sum * factor);
        }
    }
    return true;
}

} // namespace filasofia::sofaengine
