#pragma once

#include "filasofia/geometry/tet_mesh.h"

#include <cmath>
#include <cstdint>

namespace filasofia::engine {

/// The quality of geometry::quality, q = sqrt(2) 6 V / l_rms^3, for four points.
inline double tetQuality(const std::array<Vec3, 4>& p)
{
    double squares = 0.0;
    for (auto [i, j] : geometry::kTetrahedronEdges) squares += lengthSquared(p[j] - p[i]);
    const double mean = squares / 6.0;
    if (!(mean > 0.0)) return 0.0;
    return std::sqrt(2.0) * 6.0 * geometry::signedVolume(p[0], p[1], p[2], p[3]) / (mean * std::sqrt(mean));
}

/// The values at an element's corners.
inline std::array<Vec3, 4> cornersOf(const geometry::Tetrahedron& t, const std::vector<Vec3>& values)
{
    return {values[t[0]], values[t[1]], values[t[2]], values[t[3]]};
}

inline double volumeOf(const std::array<Vec3, 4>& p) { return geometry::signedVolume(p[0], p[1], p[2], p[3]); }

/// Index of the node among the corners; -1: not one of them.
constexpr int placeOf(const geometry::Tetrahedron& t, int node)
{
    for (int i = 0; i < 4; ++i)
        if (t[i] == node) return i;
    return -1;
}

/// Faces of an element as a mask: bit f is face f.
constexpr std::uint8_t bit(int face) { return static_cast<std::uint8_t>(1u << static_cast<unsigned>(face)); }
constexpr bool has(std::uint8_t mask, int face) { return (mask & bit(face)) != 0; }

/// The face's three nodes, oriented outwards.
constexpr std::array<int, 3> faceNodes(const geometry::Tetrahedron& t, int face)
{
    const auto& at = geometry::kTetrahedronFaces[face];
    return {t[at[0]], t[at[1]], t[at[2]]};
}

} // namespace filasofia::engine
