#include "filasofia/frame/topology_edit.h"

#include "filasofia/core/assert.h"
#include "filasofia/geometry/adjacency.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>

namespace filasofia::frame {
namespace {

void followElement(const TopologyOp& op, std::vector<geometry::Tetrahedron>& tetrahedra)
{
    if (const auto* split = std::get_if<TetSplit>(&op)) {
        geometry::Tetrahedron child = tetrahedra[split->parent];
        child[split->ia] = split->node;
        tetrahedra[split->parent][split->ib] = split->node;
        tetrahedra.push_back(child);
    } else if (const auto* corner = std::get_if<TetCorner>(&op)) {
        tetrahedra[corner->tetrahedron][corner->corner] = corner->node;
    }
}

/// The barycentric weights of a point; for a triangle those of its projection.
std::array<double, 4> weightsIn(const geometry::Tetrahedron& nodes, Vec3 point, const std::vector<Vec3>& rest)
{
    const Vec3 a = rest[nodes[0]], b = rest[nodes[1]], c = rest[nodes[2]];
    if (!isTriangle(nodes)) return geometry::barycentric(point, a, b, c, rest[nodes[3]]);
    std::array<double, 4> weights = geometry::barycentric(point, a, b, c, a + cross(b - a, c - a));
    weights[0] += weights[3]; // the fourth corner stood above the first
    weights[3] = 0.0;
    return weights;
}

/// Keeps the point in place while a corner moves: newRest = sum c_i X_i over the corners before the move, so the old
/// corner is newRest / c_z minus the other corners times c_i / c_z. c_z > 0 is the ratio of the element's volumes.
void stay(const NodeMove& move, const geometry::Tetrahedron& nodes, const std::vector<Vec3>& rest, EmbeddedPoint& point)
{
    const auto at = std::ranges::find(nodes, move.node);
    if (at == nodes.end()) return;
    const int z = static_cast<int>(at - nodes.begin());
    const std::array<double, 4> c = weightsIn(nodes, move.newRest, rest);
    const double w = point.weights[z] / c[z];
    for (int i = 0; i < 4; ++i) point.weights[i] = i == z ? w : point.weights[i] - w * c[i];
}

} // namespace

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

void followTetrahedra(const TopologyEdit& edit, std::vector<geometry::Tetrahedron>& tetrahedra)
{
    for (const TopologyOp& op : edit.ops) followElement(op, tetrahedra);
}

void followPoints(const TopologyEdit& edit, std::vector<geometry::Tetrahedron>& tetrahedra, std::vector<Vec3>& rest,
                  std::span<EmbeddedPoint> points)
{
    // Few points are embedded in elements that an edit touches.
    std::vector<EmbeddedPoint*> touched;
    for (EmbeddedPoint& point : points)
        if (std::ranges::binary_search(edit.changed, point.tetrahedron, {}, &TetNodes::tetrahedron))
            touched.push_back(&point);
    for (const TopologyOp& op : edit.ops) {
        if (const auto* split = std::get_if<TetSplit>(&op)) {
            for (EmbeddedPoint* point : touched)
                if (point->tetrahedron == split->parent) *point = follow(*split, *point);
        } else if (const auto* move = std::get_if<NodeMove>(&op)) {
            for (EmbeddedPoint* point : touched) stay(*move, tetrahedra[point->tetrahedron], rest, *point);
        }
        followElement(op, tetrahedra);
        followNode(op, rest);
    }
}

TopologyMirror::TopologyMirror(const std::vector<geometry::Tetrahedron>& tetrahedra)
    : tetrahedra_(tetrahedra), places_(tetrahedra.size(), {-1, -1, -1, -1})
{
    if (!tetrahedra.empty() && isTriangle(tetrahedra.front())) {
        for (int t = 0; t < static_cast<int>(tetrahedra.size()); ++t) {
            const auto& [a, b, c, none] = tetrahedra[t];
            apply({BoundaryChange::Kind::Added, t, 3, {a, b, c}, false});
        }
        return;
    }
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
    followTetrahedra(edit, tetrahedra_);
    places_.resize(tetrahedra_.size(), {-1, -1, -1, -1});
    for (const BoundaryChange& change : edit.boundary) apply(change);
}

} // namespace filasofia::frame
