#pragma once

#include "filasofia/frame/topology_edit.h"
#include "filasofia/geometry/tet_mesh.h"

#include <cmath>
#include <cstdint>
#include <span>

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

/// The nodes of an element: four, or the three of a triangle.
inline std::span<const int> nodesOf(const geometry::Tetrahedron& t)
{
    return {t.data(), frame::isTriangle(t) ? 3u : 4u};
}
inline std::span<const int> nodesOf(geometry::Tetrahedron&&) = delete;

/// As cornersOf(). A triangle gets a fourth corner 3 m above its first, which turns with it: its volume is then its
/// area [m^2], and it deforms as if all fibres across it stayed normal to it.
inline std::array<Vec3, 4> solidCorners(const geometry::Tetrahedron& t, const std::vector<Vec3>& values)
{
    if (!frame::isTriangle(t)) return cornersOf(t, values);
    const Vec3 a = values[t[0]], b = values[t[1]], c = values[t[2]];
    return {a, b, c, a + 3.0 * normalized(cross(b - a, c - a))};
}

inline Vec3 middleOf(const geometry::Tetrahedron& t, const std::vector<Vec3>& values)
{
    const std::array<Vec3, 4> p = solidCorners(t, values);
    return frame::isTriangle(t) ? 1.0 / 3.0 * (p[0] + p[1] + p[2]) : 0.25 * (p[0] + p[1] + p[2] + p[3]);
}

inline double volumeOf(const std::array<Vec3, 4>& p) { return geometry::signedVolume(p[0], p[1], p[2], p[3]); }

/// Size and shape of an element after one of its corners has moved.
struct MovedElement {
    double volume = 0.0;  ///< [m^3], or [m^2] of a triangle; negative if it was turned over
    double quality = 0.0; ///< [-] 1: regular; for a triangle 4 sqrt(3) area / (sum of its squared edges)
};

/// `p`: the corners of solidCorners(), of which corner `moved` is now at `to`.
inline MovedElement afterMove(bool triangle, std::array<Vec3, 4> p, int moved, Vec3 to)
{
    const Vec3 up = (1.0 / 3.0) * (p[3] - p[0]); // a triangle's normal before the move
    p[static_cast<std::size_t>(moved)] = to;
    if (!triangle) return {volumeOf(p), tetQuality(p)};
    const double area = 0.5 * dot(up, cross(p[1] - p[0], p[2] - p[0]));
    const double squares = lengthSquared(p[1] - p[0]) + lengthSquared(p[2] - p[1]) + lengthSquared(p[0] - p[2]);
    return {area, squares > 0.0 ? 4.0 * std::sqrt(3.0) * area / squares : 0.0};
}

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

/// The face's three nodes, oriented outwards; a triangle itself is its face 3.
constexpr std::array<int, 3> faceNodes(const geometry::Tetrahedron& t, int face)
{
    if (frame::isTriangle(t)) return {t[0], t[1], t[2]};
    const auto& at = geometry::kTetrahedronFaces[face];
    return {t[at[0]], t[at[1]], t[at[2]]};
}

/// Calls look(node) for the nodes of a face, or of a triangle's edge: all but the opposite corner.
template <class Look> void forEachFaceNode(const geometry::Tetrahedron& t, int face, const Look& look)
{
    for (int k = 0; k < 4; ++k)
        if (k != face && t[static_cast<std::size_t>(k)] != frame::kNoCorner) look(t[static_cast<std::size_t>(k)]);
}

} // namespace filasofia::engine
