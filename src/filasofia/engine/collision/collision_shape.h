#pragma once

#include "filasofia/geometry/adjacency.h"
#include "filasofia/geometry/box.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <array>
#include <cstdint>
#include <vector>

/// Collision detection: surfaces of triangles, lines and points, and the places where two of them are near each other.
/// Geometry only; forces are computed elsewhere.
namespace filasofia::engine {

/// Limits that let a pair of features be one 64-bit number (collision/proximity.h).
inline constexpr std::size_t kMaxModels = std::size_t{1} << 11;   ///< per body
inline constexpr std::size_t kMaxFeatures = std::size_t{1} << 21; ///< per shape

/// What a surface collides with. A rigid ball or capsule has two: its mesh meets tissue, which folds around its points
/// and edges, and the exact shape meets what is rigid.
enum class Partners { All, Soft, Rigid };

/// How a surface collides.
struct CollisionOptions {
    bool points = true;                            ///< its points take part
    bool lines = true;                             ///< its edges take part
    bool triangleFaces = true;                     ///< its triangles take part
    std::vector<std::array<int, 2>> segments = {}; ///< lines besides the edges of the triangles, as pairs of vertices
    std::vector<int> lone = {};                    ///< vertices of no triangle and no line that are points of their own
    /// [m], >= 0. Two surfaces are near if their distance is less than the sum of their proximities.
    double proximity = 0.5e-3;
    /// [m], >= 0; at least the proximity is used. Two surfaces are followed inside each other up to the sum of their
    /// depths.
    double depth = 0.0;
    Partners partners = Partners::All;
    bool sheet = false;   ///< a shell: whether it has a rim or not, both of its sides are outside
    int group = 0;        ///< only surfaces of the same group collide
    bool self = false;    ///< the surface collides with itself
    bool cutting = false; ///< passes through surfaces that it may cut
    bool rigid = false;   ///< never deforms
};

/// The collision topology of a surface: a triangle mesh's features, and a tree over them. Rebuilt after a topology
/// edit.
struct CollisionShape {
    /// What the tree holds: a triangle, a line of no triangle or, in a cloud of points, a point. Every vertex and edge
    /// is owned by the first element that has it, and is tested where its owner is.
    struct Element {
        std::array<int, 3> vertices{-1, -1, -1}; ///< three of a triangle, two of a line, one of a point; -1: unused
        std::array<int, 3> ownVertices{-1, -1, -1};
        std::array<int, 3> ownEdges{-1, -1, -1};
        int triangle = -1; ///< -1 if it is not a triangle
    };
    /// Nodes are in preorder: the left child follows its parent. A leaf has count > 0 elements from `first`.
    struct Node {
        int first = 0; ///< leaf: index of its first element; otherwise the right child
        int count = 0;
    };

    /// [m] vertices at rest. Features that are near each other at rest do not collide with each other.
    std::vector<Vec3> rest;
    std::vector<geometry::Triangle> triangles; ///< all triangles of the mesh, whether their faces take part or not
    std::vector<std::array<int, 2>> edges;     ///< each edge once, lower vertex first, ascending
    geometry::CompressedRows edgeTriangles;    ///< per edge, ascending
    std::vector<int> edgeOpposites;            ///< parallel to edgeTriangles.items: the triangle's third vertex
    /// Per edge of a shape that never deforms: 1 if its two triangles lie in one plane. It meets no triangle's edge:
    /// what lies across it touches the plane with a point. Empty: no edge is known to be flat.
    std::vector<char> flatEdges;
    geometry::CompressedRows vertexEdges;     ///< per vertex, ascending
    geometry::CompressedRows vertexTriangles; ///< per vertex, ascending
    bool sheet = false;                       ///< a shell
    /// Has triangles and an inside: no sheet, and every edge of theirs is traversed as often in one direction as in the
    /// other.
    bool closed = false;
    std::vector<int> lone; ///< vertices of no triangle and no line that take part

    bool points = true;
    bool lines = true;
    bool triangleFaces = true; ///< false if there are no triangles
    double proximity = 0.0;    ///< [m]
    double ownProximity = 0.0; ///< [m] the same of a solid against itself, <= proximity
    double depth = 0.0;        ///< [m], >= proximity
    Partners partners = Partners::All;
    int group = 0;
    bool self = false;
    bool cutting = false;

    std::vector<Element> elements; ///< in the order of the leaves
    std::vector<Node> nodes;       ///< empty if there are no elements
    int grafted = 0;               ///< elements that edits have inserted since the tree was built

    [[nodiscard]] double ownDepth() const { return depth - proximity + ownProximity; } ///< [m] >= ownProximity

    [[nodiscard]] bool flat(int edge) const
    {
        return !flatEdges.empty() && flatEdges[static_cast<std::size_t>(edge)] != 0;
    }

    /// Vertices, edges and triangles are numbered in one sequence.
    [[nodiscard]] int edgeFeature(int edge) const { return static_cast<int>(rest.size()) + edge; }
    [[nodiscard]] int triangleFeature(int triangle) const
    {
        return static_cast<int>(rest.size() + edges.size()) + triangle;
    }
};

/// The mesh must be one that geometry::check() accepts, or have no triangles: then the lines are the given segments
/// and, without segments, every vertex is a point of its own. Otherwise vertices of no triangle and no line are left
/// out, unless they are lone ones. The same input gives the same shape.
CollisionShape makeCollisionShape(const geometry::TriangleMesh& mesh, const CollisionOptions& options);

/// [-] (twice the area)^2 / (longest side)^4 below which a triangle has no face.
inline constexpr double kSliver = 1e-18;

/// [m] box around a triangle at rest.
geometry::Box boxOf(const CollisionShape& shape, int triangle);

} // namespace filasofia::engine
