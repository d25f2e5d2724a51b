#pragma once

#include "filasofia/geometry/adjacency.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <array>
#include <cstdint>
#include <vector>

/// Who is near whom: surfaces as triangles, lines and points, and the places where two of them are near each other.
/// Geometry only: forces are made of it elsewhere.
namespace filasofia::engine {

inline constexpr std::size_t kMostModels = std::size_t{1} << 11;   ///< of one body: pairs of features have numbers
inline constexpr std::size_t kMostFeatures = std::size_t{1} << 21; ///< of one shape: the same

/// How a surface is to be touched.
struct CollisionOptions {
    bool points = true;                            ///< do its points take part
    bool lines = true;                             ///< do its edges
    bool triangleFaces = true;                     ///< do its triangles
    std::vector<std::array<int, 2>> segments = {}; ///< lines besides the edges of the triangles, by vertices
    double proximity = 0.5e-3; ///< [m], >= 0; two surfaces are near where their distance is less than the sum of theirs
    double depth = 0.0;        ///< [m], >= 0; as the proximity where it is less. Two surfaces are followed inside
                               ///< each other as deep as the sum of theirs
    int group = 0;             ///< only surfaces of the same group meet
    bool self = false;         ///< does the surface meet itself
    bool cutting = false;      ///< goes through what it may cut
};

/// What of a body can be touched: a triangle mesh's topology, and a tree over it. Made anew after a topology edit.
struct CollisionShape {
    /// What the tree holds: a triangle, a line of no triangle or, in a cloud of points, a point. Every vertex and edge
    /// is owned by the first that has it, and looked at where its owner is.
    struct Element {
        std::array<int, 3> vertices{-1, -1, -1}; ///< three of a triangle, two of a line, one of a point; -1: none
        std::array<int, 3> ownVertices{-1, -1, -1};
        std::array<int, 3> ownEdges{-1, -1, -1};
        int triangle = -1; ///< -1: it is none
    };
    /// Nodes lie in preorder: the left child follows its parent. A leaf has count > 0 elements from `first`.
    struct Node {
        int first = 0; ///< of a leaf: place in elements; else: the right child
        int count = 0;
    };

    std::vector<Vec3> rest; ///< [m] vertices at rest: what is near there does not collide with itself
    std::vector<geometry::Triangle> triangles; ///< all of the mesh, whether their faces take part or not
    std::vector<std::array<int, 2>> edges;     ///< each once, lower vertex first, ascending
    geometry::CompressedRows edgeTriangles;    ///< per edge, ascending
    std::vector<int> edgeOpposites;            ///< beside edgeTriangles.items: the triangle's third vertex
    geometry::CompressedRows vertexEdges;      ///< per vertex, ascending
    geometry::CompressedRows vertexTriangles;  ///< per vertex, ascending
    bool closed = false; ///< has triangles, and every edge of them is walked as often in one direction as in the other

    bool points = true;
    bool lines = true;
    bool triangleFaces = true; ///< false where there is no triangle
    double proximity = 0.0;    ///< [m]
    double depth = 0.0;        ///< [m], >= proximity
    int group = 0;
    bool self = false;
    bool cutting = false;

    std::vector<Element> elements; ///< leaf by leaf
    std::vector<Node> nodes;       ///< empty where there is no element
    int grafted = 0;               ///< elements that edits have put into the tree since it was planted

    /// Vertices, edges and triangles in one row of numbers.
    [[nodiscard]] int edgeFeature(int edge) const { return static_cast<int>(rest.size()) + edge; }
    [[nodiscard]] int triangleFeature(int triangle) const
    {
        return static_cast<int>(rest.size() + edges.size()) + triangle;
    }
};

/// The mesh is one that geometry::check() accepts, or has no triangles: then the lines are the given segments and,
/// without these, every vertex is a point of its own. Vertices of no triangle and no line are left out otherwise.
/// Same input, same shape.
CollisionShape makeCollisionShape(const geometry::TriangleMesh& mesh, const CollisionOptions& options);

} // namespace filasofia::engine
