#pragma once

#include "filasofia/geometry/tet_mesh.h"

#include <span>

namespace filasofia::geometry {

/// A list of lists in two arrays: row i is items[start[i]] up to items[start[i + 1]].
struct CompressedRows {
    std::vector<int> start; ///< one more than there are rows; never descends
    std::vector<int> items;

    [[nodiscard]] int size() const { return static_cast<int>(start.size()) - 1; }
    [[nodiscard]] std::span<const int> operator[](int row) const
    {
        return std::span(items).subspan(start[row], start[row + 1] - start[row]);
    }
};

/// Every edge of the mesh once, lower node first, ascending.
std::vector<std::array<int, 2>> edges(const TetMesh& mesh);

/// Per node, the nodes that share an edge with it, ascending; itself not among them.
CompressedRows nodeNeighbours(const TetMesh& mesh);

/// Per node, the tetrahedra that use it, ascending.
CompressedRows tetrahedraAroundNodes(const TetMesh& mesh);

/// Per tetrahedron and face (in the order of kTetrahedronFaces), the tetrahedron on the other side; -1 at the surface.
/// The mesh is one that check() accepts: no face belongs to more than two.
std::vector<std::array<int, 4>> faceNeighbours(const TetMesh& mesh);

/// The pieces that a mesh falls into: two tetrahedra are in one piece when they share a node, since that node pulls
/// at both.
struct Components {
    std::vector<int> ofTetrahedron; ///< the piece of each tetrahedron, numbered in the order of their first one
    std::vector<int> ofNode;        ///< the piece of each node; -1 for a node in no tetrahedron
    int count = 0;
};

Components connectedComponents(const TetMesh& mesh);

} // namespace filasofia::geometry
