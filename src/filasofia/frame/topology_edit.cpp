#include "filasofia/frame/topology_edit.h"

#include "filasofia/core/assert.h"
#include "filasofia/geometry/adjacency.h"

#include <algorithm>

namespace filasofia::frame {

EmbeddedPoint follow(const TetSplit& split, EmbeddedPoint point)
{
    const double wa = point.weights[split.ia], wb = point.weights[split.ib], s = split.s;
    if (const double left = wa - wb * (1.0 - s) / s; left >= 0.0) {
        point.weights[split.ia] = left;
        point.weights[split.ib] = wb / s;
    } else {
        point.weights[split.ib] = wb - wa * s / (1.0 - s);
        point.weights[split.ia] = wa / (1.0 - s);
        point.tetrahedron = split.child;
    }
    return point;
}

void followPoints(const TopologyEdit& edit, std::span<EmbeddedPoint> points)
{
    // Per parent its splits in their order: a point then walks along its own elements only.
    struct Step {
        int parent;
        int order;
    };
    std::vector<const TetSplit*> splits;
    std::vector<Step> steps;
    for (const TopologyOp& op : edit.ops)
        if (const auto* split = std::get_if<TetSplit>(&op)) {
            steps.push_back({split->parent, static_cast<int>(splits.size())});
            splits.push_back(split);
        }
    if (splits.empty()) return;
    const auto before = [](const Step& a, const Step& b) {
        return a.parent != b.parent ? a.parent < b.parent : a.order < b.order;
    };
    std::ranges::sort(steps, before);
    for (EmbeddedPoint& point : points) {
        int order = 0;
        for (;;) {
            const auto next = std::lower_bound(steps.begin(), steps.end(), Step{point.tetrahedron, order}, before);
            if (next == steps.end() || next->parent != point.tetrahedron) break;
            point = follow(*splits[next->order], point);
            order = next->order + 1;
        }
    }
}

TopologyMirror::TopologyMirror(const std::vector<geometry::Tetrahedron>& tetrahedra)
    : tetrahedra_(tetrahedra), places_(tetrahedra.size(), {-1, -1, -1, -1})
{
    const std::vector<std::array<int, 4>> neighbours = geometry::faceNeighbours({{}, tetrahedra});
    for (int t = 0; t < static_cast<int>(tetrahedra.size()); ++t)
        for (int f = 0; f < 4; ++f)
            if (neighbours[t][f] < 0) {
                const auto& at = geometry::kTetrahedronFaces[f];
                const geometry::Tetrahedron& n = tetrahedra[t];
                apply({BoundaryChange::Kind::Added, t, f, {n[at[0]], n[at[1]], n[at[2]]}, false});
            }
}

void TopologyMirror::apply(const BoundaryChange& change)
{
    int& place = places_[change.tetrahedron][change.face];
    const BoundaryTriangle triangle{change.tetrahedron, change.face, change.nodes, change.opened};
    FILASOFIA_ASSERT((place < 0) == (change.kind == BoundaryChange::Kind::Added));
    if (change.kind == BoundaryChange::Kind::Added) {
        place = static_cast<int>(boundary_.size());
        boundary_.push_back(triangle);
    } else if (change.kind == BoundaryChange::Kind::Changed) {
        boundary_[place] = triangle;
    } else {
        boundary_[place] = boundary_.back();
        places_[boundary_[place].tetrahedron][boundary_[place].face] = place;
        boundary_.pop_back();
        place = -1;
    }
}

void TopologyMirror::apply(const TopologyEdit& edit)
{
    if (edit.empty()) return;
    FILASOFIA_ASSERT(edit.revision == revision_ + 1);
    revision_ = edit.revision;
    followElements(edit, tetrahedra_);
    places_.resize(tetrahedra_.size(), {-1, -1, -1, -1});
    for (const TetNodes& now : edit.changed) tetrahedra_[now.tetrahedron] = now.nodes;
    for (const BoundaryChange& change : edit.boundary) apply(change);
}

} // namespace filasofia::frame
