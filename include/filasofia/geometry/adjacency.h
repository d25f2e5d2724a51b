#pragma once

#include "filasofia/geometry/tet_mesh.h"

#include <span>

namespace filasofia::geometry {

/// A list of lists in two arrays: row i is items[start[i]] to items[start[i + 1] - 1].
struct CompressedRows {
    std::vector<int> start; ///< one entry more than there are rows; never decreases
    std::vector<int> items;

    [[nodiscard]] int size() const { return static_cast<int>(start.size()) - 1; }
    [[nodiscard]] std::span<const int> operator[](int row) const
    {
        return std::span(items).subspan(start[row], start[row + 1] - start[row]);
    }
};

/// Every edge of the mesh once, lower node first, in ascending order.
std::vector<std::array<int, 2>> edges(const TetMesh& mesh);

/// For each node, the nodes that share an edge with it, in ascending order, without the node itself.
CompressedRows nodeNeighbours(const TetMesh& mesh);

/// For each node, the tetrahedra that use it, in ascending order.
CompressedRows tetrahedraAroundNodes(const TetMesh& mesh);

/// For each tetrahedron and face (in the order of kTetrahedronFaces), the tetrahedron on the other side; -1 at the
/// surface. The mesh must pass check(): no face belongs to more than two tetrahedra.
std::vector<std::array<int, 4>> faceNeighbours(const TetMesh& mesh);

/// The pieces of a mesh: two tetrahedra are in one piece if they share a node, because forces pass through that node.
struct Components {
    std::vector<int> ofTetrahedron; ///< the piece of each tetrahedron, numbered in the order of their first tetrahedra
    std::vector<int> ofNode;        ///< the piece of each node; -1 for a node in no tetrahedron
    int count = 0;
};

Components connectedComponents(const TetMesh& mesh);

} // namespace filasofia::geometry
