#pragma once

#include "filasofia/geometry/tet_mesh.h"

#include <algorithm>
#include <array>

namespace filasofia::geometry {

/// The six tetrahedra of the cell of a grid that has its lowest corner at `low`. `node` is the number of the node at a
/// point of the grid. All are positive if the grid's axes are right-handed.
///
/// Kuhn's six: each goes from one corner of the cell to the opposite one, along the axes in a different order. In a
/// cell of odd index along an axis the path runs backwards along it, so neighbouring cells are mirror images.
template <class Node> void addKuhnCell(TetMesh& mesh, const std::array<int, 3>& low, const Node& node)
{
    std::array<std::size_t, 3> axes{0, 1, 2};
    do {
        std::array<int, 3> at{};
        bool positive = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            at[axis] = low[axis] + low[axis] % 2;
            positive ^= low[axis] % 2 != 0;
            for (std::size_t before = 0; before < axis; ++before) positive ^= axes[before] > axes[axis];
        }
        Tetrahedron t{node(at)};
        for (std::size_t step = 0; step < 3; ++step) {
            at[axes[step]] += low[axes[step]] % 2 == 0 ? 1 : -1;
            t[step + 1] = node(at);
        }
        if (!positive) std::swap(t[2], t[3]);
        mesh.tetrahedra.push_back(t);
    } while (std::next_permutation(axes.begin(), axes.end()));
}

} // namespace filasofia::geometry
