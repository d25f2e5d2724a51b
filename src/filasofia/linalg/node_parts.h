#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/linalg/node_array.h"

namespace filasofia::linalg {

/// The parts of loops over nodes: 256 nodes each. Sums depend on it: another size changes the bits of every result.
constexpr Parts nodeParts(int blocks) { return {blocks, 16}; }

/// The sum over the parts of a loop, in their order, whichever thread computes them.
template <class Part> double sumOfParts(WorkerPool& pool, Parts parts, std::vector<double>& sums, const Part& part)
{
    pool.run(parts.count(), [&](int i) { sums[static_cast<std::size_t>(i)] = part(parts[i]); });
    double sum = 0.0;
    for (int i = 0; i < parts.count(); ++i) sum += sums[static_cast<std::size_t>(i)];
    return sum;
}

} // namespace filasofia::linalg
