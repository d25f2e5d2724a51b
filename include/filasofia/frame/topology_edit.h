#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

/// What a cut or a tear did to a tetrahedral mesh, as plain data. Data per node, per element, per boundary triangle or
/// per embedded point can be updated from it alone, without knowing the mesh. Nodes and tetrahedra are only ever
/// appended, so an index keeps its meaning.
///
/// The same records tell what happened to a sheet: its triangles are elements whose fourth corner is kNoCorner, each is
/// its own triangle of the boundary (face 3), and their edges are what opens (edge f lies opposite corner f).
namespace filasofia::frame {

inline constexpr int kNoCorner = -1;
constexpr bool isTriangle(const geometry::Tetrahedron& nodes) { return nodes[3] == kNoCorner; }

/// A node on the edge from a to b: any value that is linear along the edge is (1 - s) of a plus s of b.
struct NewNode {
    int node = 0; ///< equals the number of nodes before it
    int a = 0;
    int b = 0;
    double s = 0.0; ///< [-], in (0, 1)
    friend bool operator==(const NewNode&, const NewNode&) = default;
};

/// A tetrahedron was split in two at a node on the edge between its corners ia and ib. The parent keeps its corner ia
/// and has the new node at ib; the child has the parent's former nodes, with the new node at ia. The child inherits the
/// element's data (material, rotation, history).
struct TetSplit {
    int parent = 0;
    int child = 0; ///< equals the number of tetrahedra before it
    int ia = 0;    ///< local index in the parent's four corners
    int ib = 0;    ///< local index in the parent's four corners
    int node = 0;
    double s = 0.0; ///< [-], in (0, 1): position of the node from corner ia to corner ib
    friend bool operator==(const TetSplit&, const TetSplit&) = default;
};

/// A node slid along an edge of the mesh, in the rest state and in the current one: any value that is linear along the
/// edge becomes (1 - s) of the node's plus s of toward's. The elements around it have another rest shape, and their
/// mass is distributed again.
struct NodeMove {
    int node = 0;
    int toward = 0;
    double s = 0.0;    ///< [-], in (0, 1)
    Vec3 oldRest = {}; ///< [m]
    Vec3 newRest = {}; ///< [m]
    friend bool operator==(const NodeMove&, const NodeMove&) = default;
};

/// A node was duplicated at the same position; the elements that now use the copy follow as TetCorner.
struct NodeCopy {
    int from = 0;
    int copy = 0; ///< equals the number of nodes before it
    friend bool operator==(const NodeCopy&, const NodeCopy&) = default;
};

/// One corner of a tetrahedron is now another node.
struct TetCorner {
    int tetrahedron = 0;
    int corner = 0; ///< local index in its four corners
    int node = 0;
    friend bool operator==(const TetCorner&, const TetCorner&) = default;
};

using TopologyOp = std::variant<NewNode, TetSplit, NodeMove, NodeCopy, TetCorner>;

/// The corners of a tetrahedron after the edit.
struct TetNodes {
    int tetrahedron = 0;
    geometry::Tetrahedron nodes = {};
    friend bool operator==(const TetNodes&, const TetNodes&) = default;
};

/// The change of one triangle of the boundary, identified by its tetrahedron and its face (in the order of
/// kTetrahedronFaces).
struct BoundaryChange {
    enum class Kind : std::uint8_t { Added, Removed, Changed };
    Kind kind = Kind::Added;
    int tetrahedron = 0;
    int face = 0;
    geometry::Triangle nodes = {}; ///< counter-clockwise seen from outside; for a removed triangle, its former nodes
    bool opened = false;           ///< inside the tissue until a cut or a tear opened it
    friend bool operator==(const BoundaryChange&, const BoundaryChange&) = default;
};

/// All changes of one body's mesh between two observations.
struct TopologyEdit {
    BodyId body = {};
    std::uint64_t revision =
        0;              ///< revision of the mesh after the edit: 1 for its first edit, increased by one for each
    int nodes = 0;      ///< after the edit
    int tetrahedra = 0; ///< after the edit
    std::vector<TopologyOp> ops = {}; ///< in the order in which they happened
    /// every tetrahedron that is new, or has other nodes, another rest shape or another neighbour, in ascending order
    std::vector<TetNodes> changed = {};
    std::vector<BoundaryChange> boundary =
        {}; ///< differences between the boundary before and after, sorted by tetrahedron and face

    [[nodiscard]] bool empty() const { return ops.empty() && changed.empty() && boundary.empty(); }
    friend bool operator==(const TopologyEdit&, const TopologyEdit&) = default;
};

/// Updates a value per node that is linear along edges (positions, velocities, texture coordinates, coarse weights).
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

/// Updates values per element: a child inherits its parent's.
template <class Value> void followElements(const TopologyEdit& edit, std::vector<Value>& values)
{
    for (const TopologyOp& op : edit.ops)
        if (const auto* split = std::get_if<TetSplit>(&op)) values.push_back(Value(values[split->parent]));
}

/// Updates the elements themselves.
void followTetrahedra(const TopologyEdit& edit, std::vector<geometry::Tetrahedron>& tetrahedra);

/// A point embedded in a tetrahedron.
struct EmbeddedPoint {
    int tetrahedron = 0;
    std::array<double, 4> weights = {}; ///< barycentric; they sum to 1
    friend bool operator==(const EmbeddedPoint&, const EmbeddedPoint&) = default;
};

/// The point of the parent after the split: the same position, with weights that stay non-negative if they were: w_a' =
/// w_a - w_b (1-s)/s in the parent if that is >= 0, otherwise w_b' = w_b - w_a s/(1-s) in the child.
EmbeddedPoint follow(const TetSplit& split, EmbeddedPoint point);

/// Updates all points so that they stay at the same rest position whatever nodes slid. If a slide moved an element away
/// from its point, the point stays embedded in it from outside, with a negative weight. Elements and rest positions
/// before the edit are updated on the way.
void followPoints(const TopologyEdit& edit, std::vector<geometry::Tetrahedron>& tetrahedra, std::vector<Vec3>& rest,
                  std::span<EmbeddedPoint> points);

/// A triangle of the boundary.
struct BoundaryTriangle {
    int tetrahedron = 0;
    int face = 0;
    geometry::Triangle nodes = {}; ///< counter-clockwise seen from outside
    bool opened = false;           ///< opened by a cut or a tear
    friend bool operator==(const BoundaryTriangle&, const BoundaryTriangle&) = default;
};

/// Elements and boundary of a mesh, reconstructed from its edits alone.
class TopologyMirror {
public:
    explicit TopologyMirror(const std::vector<geometry::Tetrahedron>& tetrahedra);

    /// Edits must be applied in their order, with none left out.
    void apply(const TopologyEdit& edit);

    [[nodiscard]] const std::vector<geometry::Tetrahedron>& tetrahedra() const { return tetrahedra_; }
    /// In no particular order: a removed triangle is replaced by the last one.
    [[nodiscard]] const std::vector<BoundaryTriangle>& boundary() const { return boundary_; }

private:
    void apply(const BoundaryChange& change);

    std::uint64_t revision_ = 0;
    std::vector<geometry::Tetrahedron> tetrahedra_;
    std::vector<BoundaryTriangle> boundary_;
    std::vector<std::array<int, 4>> places_; ///< index in boundary_, per tetrahedron and face; -1 if there is none
};

} // namespace filasofia::frame
