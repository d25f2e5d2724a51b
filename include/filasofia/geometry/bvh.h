#pragma once

#include "filasofia/geometry/box.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace filasofia::geometry {

/// A bounding volume hierarchy: a balanced binary tree of boxes over primitives that are known only by index and box.
/// Queries allocate only in the caller's list, and may run on several threads at once.
class Bvh {
public:
    /// The result of nearest() and firstHit(); primitive is -1 if there is none.
    struct Found {
        int primitive = -1;
        double value = Box::kFar;
    };

    Bvh() = default;
    /// Builds the tree; every box must be finite and not empty. The same boxes give the same tree.
    explicit Bvh(std::span<const Box> boxes);

    /// Takes new boxes for the same primitives and keeps the tree's shape. Queries stay correct, and stay fast as long
    /// as neighbours stay neighbours. A box may be anything, even empty or NaN; such a primitive is never found.
    void refit(std::span<const Box> boxes);

    [[nodiscard]] int size() const { return static_cast<int>(order_.size()); }
    /// The box around everything.
    [[nodiscard]] Box bounds() const { return nodes_.empty() ? Box{} : nodes_.front().box; }

    /// Replaces the content of `found` by the primitives whose boxes overlap `query`, in ascending order.
    void overlapping(const Box& query, std::vector<int>& found) const;

    /// The primitive with the smallest squaredDistance(primitive) [m^2] <= `atMost`; ties go to the lowest index. The
    /// function returns the exact squared distance from p, never less than that to the primitive's box.
    template <class SquaredDistance>
    [[nodiscard]] Found nearest(Vec3 p, SquaredDistance&& squaredDistance, double atMost = Box::kFar) const
    {
        const auto bound = [p](const Box& box) { return geometry::squaredDistance(box, p); };
        return smallest(bound, squaredDistance, atMost);
    }

    /// The first primitive that the ray hits: hit(primitive) returns how far along, in lengths of `direction`, or
    /// infinity. Ties go to the lowest index; hits beyond `atMost` do not count.
    template <class Hit>
    [[nodiscard]] Found firstHit(Vec3 origin, Vec3 direction, Hit&& hit, double atMost = Box::kFar) const
    {
        const Vec3 inverse{1.0 / direction.x, 1.0 / direction.y, 1.0 / direction.z};
        const auto bound = [origin, inverse](const Box& box) { return rayEntry(box, origin, inverse); };
        return smallest(bound, hit, atMost);
    }

    /// Replaces the content of `found` by every pair (primitive of a, primitive of b) whose boxes overlap, in ascending
    /// order.
    friend void overlappingPairs(const Bvh& a, const Bvh& b, std::vector<std::array<int, 2>>& found);

private:
    // Nodes are stored in preorder: the left child follows its parent. A leaf has count > 0 primitives from
    // order_[first].
    struct Node {
        Box box;
        int first = 0; // leaf: place in order_; inner node: the right child
        int count = 0;
    };
    static constexpr int kLeafSize = 4;
    static constexpr int kMaxDepth = 64; // the count is halved at every level, so 32 would be enough

    int build(std::span<const Box> boxes, int first, int count);
    void collectPairs(const Bvh& other, int mine, int theirs, std::vector<std::array<int, 2>>& found) const;
    static double rayEntry(const Box& box, Vec3 origin, Vec3 inverseDirection);

    // Branch and bound: bound(box) is at most value(primitive) of every primitive inside, up to rounding.
    template <class Bound, class Value> Found smallest(const Bound& bound, Value& value, double atMost) const;

    std::vector<Node> nodes_;
    std::vector<int> order_; // primitives, leaf by leaf
    std::vector<Box> boxes_; // indexed by primitive; all NaN if the primitive cannot be found
};

void overlappingPairs(const Bvh& a, const Bvh& b, std::vector<std::array<int, 2>>& found);

template <class Bound, class Value> Bvh::Found Bvh::smallest(const Bound& bound, Value& value, double atMost) const
{
    constexpr double kRounding = 1.0 - 1e-12; // a bound and the value it bounds are rounded differently
    // A primitive that is infinitely far, or missed by the ray, is not found even if there is no other.
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
        if (!(top.bound <= best.value)) continue; // equal bounds are visited: they may hold a lower index
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
