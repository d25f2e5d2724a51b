#pragma once

#include "filasofia/geometry/box.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace filasofia::geometry {

/// A bounding volume hierarchy: a balanced binary tree of boxes over primitives that are known by index and box only.
/// Queries allocate nothing but room in the caller's list, and may run on several threads at once.
class Bvh {
public:
    /// What nearest() and firstHit() answer; primitive -1: none.
    struct Found {
        int primitive = -1;
        double value = Box::kFar;
    };

    Bvh() = default;
    /// Builds the tree; every box is finite and not empty. Same boxes, same tree.
    explicit Bvh(std::span<const Box> boxes);

    /// Takes new boxes for the same primitives and keeps the tree's shape: right, and fast while neighbours stay
    /// neighbours. A box may be anything, also empty or NaN; such a primitive is just not found.
    void refit(std::span<const Box> boxes);

    [[nodiscard]] int size() const { return static_cast<int>(order_.size()); }
    /// The box around everything.
    [[nodiscard]] Box bounds() const { return nodes_.empty() ? Box{} : nodes_.front().box; }

    /// The primitives whose boxes meet `query`, ascending, in place of what `found` held.
    void overlapping(const Box& query, std::vector<int>& found) const;

    /// The primitive with the smallest squaredDistance(primitive) [m^2] <= `atMost`; ties go to the lowest index.
    /// That function is the exact distance from p and never less than that to the primitive's box.
    template <class SquaredDistance>
    [[nodiscard]] Found nearest(Vec3 p, SquaredDistance&& squaredDistance, double atMost = Box::kFar) const
    {
        const auto bound = [p](const Box& box) { return geometry::squaredDistance(box, p); };
        return smallest(bound, squaredDistance, atMost);
    }

    /// The primitive that the ray meets first: hit(primitive) tells how far along, in lengths of `direction`, or
    /// infinity. Ties go to the lowest index; hits beyond `atMost` do not count.
    template <class Hit>
    [[nodiscard]] Found firstHit(Vec3 origin, Vec3 direction, Hit&& hit, double atMost = Box::kFar) const
    {
        const Vec3 inverse{1.0 / direction.x, 1.0 / direction.y, 1.0 / direction.z};
        const auto bound = [origin, inverse](const Box& box) { return rayEntry(box, origin, inverse); };
        return smallest(bound, hit, atMost);
    }

    /// Every pair (of a, of b) whose boxes meet, ascending, in place of what `found` held.
    friend void overlappingPairs(const Bvh& a, const Bvh& b, std::vector<std::array<int, 2>>& found);

private:
    // Nodes lie in preorder: the left child follows its parent. A leaf has count > 0 primitives from order_[first].
    struct Node {
        Box box;
        int first = 0; // of a leaf: place in order_; else: the right child
        int count = 0;
    };
    static constexpr int kLeafSize = 4;
    static constexpr int kMaxDepth = 64; // the tree halves its count at every level: 32 would do

    int build(std::span<const Box> boxes, int first, int count);
    void collectPairs(const Bvh& other, int mine, int theirs, std::vector<std::array<int, 2>>& found) const;
    static double rayEntry(const Box& box, Vec3 origin, Vec3 inverseDirection);

    // Branch and bound: bound(box) is at most value(primitive) of everything inside, but for rounding.
    template <class Bound, class Value> Found smallest(const Bound& bound, Value& value, double atMost) const;

    std::vector<Node> nodes_;
    std::vector<int> order_; // primitives, leaf by leaf
    std::vector<Box> boxes_; // by primitive; all NaN where there is nothing to find
};

void overlappingPairs(const Bvh& a, const Bvh& b, std::vector<std::array<int, 2>>& found);

template <class Bound, class Value> Bvh::Found Bvh::smallest(const Bound& bound, Value& value, double atMost) const
{
    constexpr double kRounding = 1.0 - 1e-12; // a bound and the value it bounds are rounded differently
    // What is infinitely far, or missed by the ray, is not found even where nothing else is.
    Found best{-1, std::min(atMost, std::numeric_limits<double>::max())};
    if (nodes_.empty()) return best;
    struct Entry {
        int node;
        double bound;
    };
    std::array<Entry, kMaxDepth> stack;
    int height = 0;
    stack[height++] = {0, bound(nodes_[0].box) * kRounding};
    while (height > 0) {
        const Entry top = stack[--height];
        if (!(top.bound <= best.value)) continue; // equal ones go on: they may hold a lower index
        const Node& node = nodes_[top.node];
        for (int i = 0; i < node.count; ++i) {
            const int primitive = order_[node.first + i];
            const Box& box = boxes_[primitive];
            if (isEmpty(box) || !(bound(box) * kRounding <= best.value)) continue;
            const double v = value(primitive);
            if (v < best.value || (v == best.value && (best.primitive < 0 || primitive < best.primitive)))
                best = {primitive, v};
        }
        if (node.count > 0) continue;
        // The nearer child goes on top, so that the farther one is often never opened.
        Entry left{top.node + 1, bound(nodes_[top.node + 1].box) * kRounding};
        Entry right{node.first, bound(nodes_[node.first].box) * kRounding};
        if (left.bound <= right.bound) std::swap(left, right);
        stack[height++] = left;
        stack[height++] = right;
    }
    if (best.primitive < 0) best.value = Box::kFar;
    return best;
}

} // namespace filasofia::geometry
