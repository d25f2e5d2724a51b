#include "filasofia/geometry/bvh.h"

#include "filasofia/core/assert.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace filasofia::geometry {

Bvh::Bvh(std::span<const Box> boxes) : order_(boxes.size()), boxes_(boxes.begin(), boxes.end())
{
    for (const Box& box : boxes) FILASOFIA_ASSERT(isFinite(box.low) && isFinite(box.high) && !isEmpty(box));
    std::iota(order_.begin(), order_.end(), 0);
    if (boxes.empty()) return;
    nodes_.reserve(2 * boxes.size());
    build(boxes, 0, size());
}

// Halves the primitives at the median of their centres along the axis on which these are spread the most. A surface
// area heuristic makes trees that are a little faster to query and several times slower to build.
int Bvh::build(std::span<const Box> boxes, int first, int count)
{
    const int self = static_cast<int>(nodes_.size());
    nodes_.push_back({{}, first, count});
    const auto begin = order_.begin() + first, end = begin + count;
    Box all, middles;
    for (auto it = begin; it != end; ++it) {
        all = merged(all, boxes[*it]);
        middles = merged(middles, 0.5 * boxes[*it].low + 0.5 * boxes[*it].high);
    }
    nodes_[self].box = all;
    if (count <= kLeafSize) return std::sort(begin, end), self;

    const Vec3 spread = middles.high - middles.low;
    const int axis = spread.x >= spread.y && spread.x >= spread.z ? 0 : spread.y >= spread.z ? 1 : 2;
    // Equal centres are ordered by index, so the halves are the same whatever nth_element does inside.
    const auto before = [&](int a, int b) {
        const double ma = 0.5 * boxes[a].low[axis] + 0.5 * boxes[a].high[axis];
        const double mb = 0.5 * boxes[b].low[axis] + 0.5 * boxes[b].high[axis];
        return ma != mb ? ma < mb : a < b;
    };
    const int half = count / 2;
    std::nth_element(begin, begin + half, end, before);
    build(boxes, first, half);
    const int right = build(boxes, first + half, count - half);
    nodes_[self].first = right;
    nodes_[self].count = 0;
    return self;
}

void Bvh::refit(std::span<const Box> boxes)
{
    FILASOFIA_ASSERT(static_cast<int>(boxes.size()) == size());
    // Nothing overlaps a box of NaN, not even a box around all space.
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    for (int i = 0; i < size(); ++i)
        boxes_[i] = isEmpty(boxes[i]) ? Box{{kNan, kNan, kNan}, {kNan, kNan, kNan}} : boxes[i];
    // Children lie behind their parent: going backwards, every child is ready before it is needed.
    for (int i = static_cast<int>(nodes_.size()) - 1; i >= 0; --i) {
        Node& node = nodes_[i];
        if (node.count == 0) {
            node.box = merged(nodes_[i + 1].box, nodes_[node.first].box);
            continue;
        }
        node.box = {};
        for (int k = 0; k < node.count; ++k)
            if (const Box& box = boxes_[order_[node.first + k]]; !isEmpty(box)) node.box = merged(node.box, box);
    }
}

void Bvh::overlapping(const Box& query, std::vector<int>& found) const
{
    found.clear();
    if (nodes_.empty()) return;
    std::array<int, kMaxDepth> stack;
    int height = 0;
    stack[height++] = 0;
    while (height > 0) {
        const int at = stack[--height];
        const Node& node = nodes_[at];
        if (!overlap(node.box, query)) continue;
        for (int i = 0; i < node.count; ++i)
            if (overlap(boxes_[order_[node.first + i]], query)) found.push_back(order_[node.first + i]);
        if (node.count == 0) stack[height++] = node.first, stack[height++] = at + 1;
    }
    std::ranges::sort(found);
}

// Opens the node that is not a leaf, or the larger one, so that both trees shrink at the same pace.
void Bvh::collectPairs(const Bvh& other, int mine, int theirs, std::vector<std::array<int, 2>>& found) const
{
    const Node &a = nodes_[mine], &b = other.nodes_[theirs];
    if (!overlap(a.box, b.box)) return;
    if (a.count > 0 && b.count > 0) {
        for (int i = 0; i < a.count; ++i)
            for (int k = 0; k < b.count; ++k) {
                const int p = order_[a.first + i], q = other.order_[b.first + k];
                if (overlap(boxes_[p], other.boxes_[q])) found.push_back({p, q});
            }
        return;
    }
    const bool openMine =
        b.count > 0 || (a.count == 0 && lengthSquared(a.box.high - a.box.low) >= lengthSquared(b.box.high - b.box.low));
    if (openMine) {
        collectPairs(other, mine + 1, theirs, found);
        collectPairs(other, a.first, theirs, found);
    } else {
        collectPairs(other, mine, theirs + 1, found);
        collectPairs(other, mine, b.first, found);
    }
}

void overlappingPairs(const Bvh& a, const Bvh& b, std::vector<std::array<int, 2>>& found)
{
    found.clear();
    if (a.nodes_.empty() || b.nodes_.empty()) return;
    a.collectPairs(b, 0, 0, found);
    std::ranges::sort(found);
}

double Bvh::rayEntry(const Box& box, Vec3 origin, Vec3 inverseDirection)
{
    // The slab method (Kay and Kajiya 1986).
    double enter = 0.0, leave = Box::kFar;
    for (int axis = 0; axis < 3; ++axis) {
        const double t0 = (box.low[axis] - origin[axis]) * inverseDirection[axis];
        const double t1 = (box.high[axis] - origin[axis]) * inverseDirection[axis];
        // If the ray runs along a slab's border, 0 times infinity is a NaN, and this slab clips nothing.
        if (std::isnan(t0) || std::isnan(t1)) continue;
        enter = std::max(enter, std::min(t0, t1));
        leave = std::min(leave, std::max(t0, t1));
    }
    // A flat box is entered and left at once; rounding must not make it a miss.
    return enter <= leave * (1.0 + 1e-12) ? enter : Box::kFar;
}

} // namespace filasofia::geometry
