#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

namespace filasofia {

/// Disjoint sets of numbers (union-find). The lowest number of a set represents it, in whatever order sets were joined.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
    int find(int i)
    {
        while (at(i) != i) i = at(i) = at(at(i));
        return i;
    }
    void join(int a, int b)
    {
        a = find(a), b = find(b);
        at(std::max(a, b)) = std::min(a, b);
    }

private:
    int& at(int i) { return parent_[static_cast<std::size_t>(i)]; }

    std::vector<int> parent_;
};

} // namespace filasofia
