#pragma once

#include <algorithm>
#include <vector>

namespace filasofia {

/// Sorts the list in ascending order and removes duplicates.
template <class Value> void sortUnique(std::vector<Value>& list)
{
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
}

} // namespace filasofia
