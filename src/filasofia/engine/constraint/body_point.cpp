#include "filasofia/engine/constraint/body_point.h"

#include "filasofia/core/assert.h"

namespace filasofia::engine {

void BodyPoint::add(int node, double weight)
{
    if (weight == 0.0) return;
    for (int i = 0; i < count; ++i)
        if (nodes[static_cast<std::size_t>(i)] == node) {
            weights[static_cast<std::size_t>(i)] += weight;
            return;
        }
    FILASOFIA_ASSERT(count < static_cast<int>(nodes.size()));
    nodes[static_cast<std::size_t>(count)] = node;
    weights[static_cast<std::size_t>(count++)] = weight;
}

} // namespace filasofia::engine
