#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

/// What a cut or a tear did to a tetrahedral mesh, as plain data: whoever keeps something per node, per element, per
/// boundary triangle or per embedded point follows from this alone, without knowing the mesh. Nodes and tetrahedra are
/// only ever appended, so an index once given keeps its meaning.
namespace filasofia::frame {

/// A node on the edge from a to b: whatever is linear along it is (1 - s) of a plus s of b.
struct NewNode {
    int node = 0; ///< the number of nodes before it
    int a = 0;
    int b = 0;
    double s = 0.0; ///< [-], in (0, 1)
    friend bool operator==(const NewNode&, const NewNode&) = default;
};

/// A tetrahedron became two at a node on the edge between its corners ia and ib. The parent keeps its corner ia and has
/// the node at ib; the child is what the parent was, with the node at ia. What an element has (material, rotation, what
/// it remembers) the child inherits.
struct TetSplit {
    int parent = 0;
    int child = 0; ///< the number of tetrahedra before it
    int ia = 0;    ///< place in the parent's four corners
    int ib = 0;    ///< place in the parent's four corners
    int node = 0;
    double s = 0.0; ///< [-], in (0, 1): where the node lies on the way from corner ia to corner ib
    friend bool operator==(const TetSplit&, const TetSplit&) = default;
};

/// A node slid along an edge of the mesh, at rest and as it is now: whatever is linear along the edge becomes (1 - s)
/// of the node's plus s of toward's. Elements around it have another
/// shape at rest, and share out their mass anew.
struct NodeMove {
    int node = 0;
    int toward = 0;
    double s = 0.0;    ///< [-], in (0, 1)
    Vec3 oldRest = {}; ///< [m]
    Vec3 newRest = {}; ///< [m]
    friend bool operator==(const NodeMove&, const NodeMove&) = default;
};

/// A node became two at the same place; the elements that went with the copy follow as TetCorner.
struct NodeCopy {
    int from = 0;
    int copy = 0; ///< the number of nodes before it
    friend bool operator==(const NodeCopy&, const NodeCopy&) = default;
};

/// A tetrahedron's corner is another node now.
struct TetCorner {
    int tetrahedron = 0;
    int corner = 0; ///< place in its four
    int node = 0;
    friend bool operator==(const TetCorner&, const TetCorner&) = default;
};

using TopologyOp = std::variant<NewNode, TetSplit, NodeMove, NodeCopy, TetCorner>;

/// What a tetrahedron's corners are after the edit.
struct TetNodes {
    int tetrahedron = 0;
    geometry::Tetrahedron nodes = {};
    friend bool operator==(const TetNodes&, const TetNodes&) = default;
};

/// What became of one triangle of the boundary. Its name is its tetrahedron and the face of it (in the order of
/// kTetrahedronFaces).
struct BoundaryChange {
    enum class Kind : std::uint8_t { Added, Removed, Changed };
    Kind kind = Kind::Added;
    int tetrahedron = 0;
    int face = 0;
    geometry::Triangle nodes = {}; ///< outwards; of a removed one, what they were
    bool opened = false;           ///< inside the tissue until a cut or a tear opened it
    friend bool operator==(const BoundaryChange&, const BoundaryChange&) = default;
};

/// All that happened to one body's mesh between two looks at it.
struct TopologyEdit {
    BodyId body = {};
    std::uint64_t revision = 0;                ///< of the mesh after the edit: 1 for its first, one more for each
    int nodes = 0;                             ///< after the edit
    int tetrahedra = 0;                        ///< after the edit
    std::vector<TopologyOp> ops = {};          ///< in the order in which they happened
    std::vector<TetNodes> changed = {};        ///< every tetrahedron that is new, or has other nodes, another
                                               ///< shape at rest or another neighbour, ascending
    std::vector<BoundaryChange> boundary = {}; ///< from before to after, ascending by tetrahedron and face

    [[nodiscard]] bool empty() const { return ops.empty() && changed.empty() && boundary.empty(); }
    friend bool operator==(const TopologyEdit&, const TopologyEdit&) = default;
};

/// A value per node that is linear along edges (positions, velocities, texture coordinates, coarse weights) follows.
template <class Value> void followNode(const TopologyOp& op, std::vector<Value>& values)
{
    if (const auto* made = std::get_if<NewNode>(&op))
        values.push_back((1.0 - made->s) * values[made->a] + made->s * values[made->b]);
    else if (const auto* moved = std::get_if<NodeMove>(&op))
        values[moved->node] = (1.0 - moved->s) * values[moved->node] + moved->s * values[moved->toward];
    else if (const auto* copied = std::get_if<NodeCopy>(&op))
        values.push_back(Value(values[copied->from]));
}
template <class Value> void followNodes(const TopologyEdit& edit, std::vector<Value>& values)
{
    for (const TopologyOp& op : edit.ops) followNode(op, values);
}

/// Values of elements follow the edit: a child has its parent's.
template <class Value> void followElements(const TopologyEdit& edit, std::vector<Value>& values)
{
    for (const TopologyOp& op : edit.ops)
        if (const auto* split = std::get_if<TetSplit>(&op)) values.push_back(Value(values[split->parent]));
}

/// The elements themselves follow the edit.
void followTetrahedra(const TopologyEdit& edit, std::vector<geometry::Tetrahedron>& tetrahedra);

/// A point that rides on a tetrahedron.
struct EmbeddedPoint {
    int tetrahedron = 0;
    std::array<double, 4> weights = {}; ///< barycentric; they sum to 1
    friend bool operator==(const EmbeddedPoint&, const EmbeddedPoint&) = default;
};

/// Where a point of the parent is after the split; the same place, with weights that are not negative where they were
/// not: w_a' = w_a - w_b (1-s)/s in the parent where that is >= 0, otherwise w_b' = w_b - w_a s/(1-s) in the child.
EmbeddedPoint follow(const TetSplit& split, EmbeddedPoint point);

/// All points follow the edit and stay at the same place at rest, whatever nodes slid; those whose element a slide took
/// away from them ride on it from outside, with a negative weight. The mesh as it was, elements and rest positions,
/// follows on the way.
void followPoints(const TopologyEdit& edit, std::vector<geometry::Tetrahedron>& tetrahedra, std::vector<Vec3>& rest,
                  std::span<EmbeddedPoint> points);

/// A triangle of the boundary.
struct BoundaryTriangle {
    int tetrahedron = 0;
    int face = 0;
    geometry::Triangle nodes = {}; ///< outwards
    bool opened = false;           ///< by a cut or a tear
    friend bool operator==(const BoundaryTriangle&, const BoundaryTriangle&) = default;
};

/// What somebody knows of a mesh who has only ever seen its edits: elements and boundary.
class TopologyMirror {
public:
    explicit TopologyMirror(const std::vector<geometry::Tetrahedron>& tetrahedra);

    /// Edits come in their order, none left out.
    void apply(const TopologyEdit& edit);

    [[nodiscard]] const std::vector<geometry::Tetrahedron>& tetrahedra() const { return tetrahedra_; }
    /// In no special order: a removed one leaves its place to the last.
    [[nodiscard]] const std::vector<BoundaryTriangle>& boundary() const { return boundary_; }

private:
    void apply(const BoundaryChange& change);

    std::uint64_t revision_ = 0;
    std::vector<geometry::Tetrahedron> tetrahedra_;
    std::vector<BoundaryTriangle> boundary_;
    std::vector<std::array<int, 4>> places_; ///< in boundary_, per tetrahedron and face; -1: none
};

} // namespace filasofia::frame
