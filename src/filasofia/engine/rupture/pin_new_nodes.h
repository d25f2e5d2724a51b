#pragma once

#include "filasofia/physics/attachment_def.h"

#include <algorithm>
#include <vector>

namespace filasofia::engine {

/// Whether a group of pins, whose `nodes` ascend, holds a node hard.
template <class Group> bool holdsHard(const Group& group, int node)
{
    return group.stiffness == physics::kHard && std::ranges::binary_search(group.nodes, node);
}

/// A new node between two nodes that are held hard is pinned by the groups that pin both, or if there is none, by all
/// groups that pin one of them. `pin(group)` adds it.
template <class Group, class Pin> void pinBetween(int a, int b, std::vector<Group>& groups, const Pin& pin)
{
    const auto both = [&](const Group& each) { return holdsHard(each, a) && holdsHard(each, b); };
    const bool anyBoth = std::ranges::any_of(groups, both);
    for (Group& group : groups)
        if (anyBoth ? both(group) : holdsHard(group, a) || holdsHard(group, b)) pin(group);
}

} // namespace filasofia::engine
