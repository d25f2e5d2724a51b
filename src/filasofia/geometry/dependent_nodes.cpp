#include "filasofia/geometry/dependent_nodes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace filasofia::geometry {
namespace {

constexpr double kIndependent = 0.01; // [-] least part of a coarse node's own P^T P that others do not explain
constexpr double kLeastKept = 0.2;    // [-] a node keeps at least this much of its weight

/// P^T P, row by row.
std::vector<double> products(const CoarseLattice& lattice, std::size_t count)
{
    std::vector<double> out(count * count);
    for (std::size_t i = 0; i < lattice.corners.size(); ++i)
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = 0; b < 4; ++b) {
                const double product = static_cast<double>(lattice.weights[i][a]) * lattice.weights[i][b];
                if (product == 0.0) continue;
                out[static_cast<std::size_t>(lattice.corners[i][a]) * count +
                    static_cast<std::size_t>(lattice.corners[i][b])] += product;
            }
    return out;
}

/// Cholesky's factorisation in the order of the largest remainders. A coarse node of which nearly nothing remains when
/// its turn comes depends on those before it.
std::vector<char> dependent(const std::vector<double>& matrix, std::size_t count)
{
    std::vector<double> rows(count * count); // of the factor
    std::vector<double> left(count), own(count);
    for (std::size_t c = 0; c < count; ++c) left[c] = own[c] = matrix[c * count + c];
    std::vector<char> done(count), drop(count);
    std::size_t columns = 0;
    for (std::size_t turn = 0; turn < count; ++turn) {
        std::size_t next = count;
        for (std::size_t c = 0; c < count; ++c)
            if (!done[c] && (next == count || left[c] > left[next])) next = c;
        done[next] = 1;
        if (!(left[next] > kIndependent * own[next])) {
            drop[next] = 1;
            continue;
        }
        const std::span pivot = std::span(rows).subspan(next * count, columns);
        for (std::size_t c = 0; c < count; ++c) {
            if (done[c]) continue;
            double sum = matrix[c * count + next];
            for (std::size_t k = 0; k < columns; ++k) sum -= rows[c * count + k] * pivot[k];
            const double entry = sum / std::sqrt(left[next]);
            rows[c * count + columns] = entry;
            left[c] -= entry * entry;
        }
        ++columns;
    }
    return drop;
}

} // namespace

void dropDependent(CoarseLattice& lattice)
{
    const auto count = static_cast<std::size_t>(lattice.nodeCount);
    std::vector<char> drop = dependent(products(lattice, count), count);
    if (std::ranges::find(drop, 1) == drop.end()) return;
    const auto kept = [&](std::size_t i) {
        double sum = 0.0;
        for (std::size_t k = 0; k < 4; ++k)
            if (!drop[static_cast<std::size_t>(lattice.corners[i][k])]) sum += lattice.weights[i][k];
        return sum;
    };
    for (std::size_t i = 0; i < lattice.corners.size(); ++i) {
        const auto largest =
            static_cast<std::size_t>(std::ranges::max_element(lattice.weights[i]) - lattice.weights[i].begin());
        if (lattice.weights[i][largest] > 0.0f && kept(i) < kLeastKept)
            drop[static_cast<std::size_t>(lattice.corners[i][largest])] = 0;
    }
    for (std::size_t i = 0; i < lattice.corners.size(); ++i) {
        const double sum = kept(i);
        if (sum == 0.0) continue;
        for (std::size_t k = 0; k < 4; ++k) {
            float& weight = lattice.weights[i][k];
            weight = drop[static_cast<std::size_t>(lattice.corners[i][k])] ? 0.0f : static_cast<float>(weight / sum);
        }
    }
}

} // namespace filasofia::geometry
