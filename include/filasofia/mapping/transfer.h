#pragma once

#include "filasofia/geometry/triangle_mesh.h"

#include <array>
#include <vector>

namespace filasofia::mapping {

/// How values at the vertices of a surface are transferred to the surface that replaces it after a cut.
struct SurfaceTransfer {
    static constexpr int kNone = -1;
    std::vector<std::array<int, 3>> vertices;   ///< per new vertex, three old ones; kNone if it lies on none
    std::vector<std::array<double, 3>> weights; ///< their weights

    friend bool operator==(const SurfaceTransfer&, const SurfaceTransfer&) = default;
};

/// For each vertex of `fresh`, its position on the old surface, both at rest. A vertex that existed keeps its values
/// exactly, one on an edge or a triangle gets the weighted mean, and one that was inside the tissue (farther from the
/// surface than a millionth of its size) gets a default value.
SurfaceTransfer transferBetween(const geometry::TriangleMesh& old, const geometry::TriangleMesh& fresh);

/// The values of the new surface; `values` has one for each vertex of the old one. Values must support addition and
/// multiplication by a number from the left.
template <class Value> std::vector<Value> carry(const SurfaceTransfer& transfer, const std::vector<Value>& values)
{
    std::vector<Value> moved(transfer.vertices.size());
    for (std::size_t i = 0; i < moved.size(); ++i) {
        if (transfer.vertices[i][0] == SurfaceTransfer::kNone) continue;
        const auto& [a, b, c] = transfer.vertices[i];
        const auto& [u, v, w] = transfer.weights[i];
        moved[i] = u * values[std::size_t(a)] + v * values[std::size_t(b)] + w * values[std::size_t(c)];
    }
    return moved;
}

} // namespace filasofia::mapping
