#pragma once

#include "filasofia/engine/collision/collision_surface.h"

namespace filasofia::engine {

/// [-] Boxes around the normals of a surface: those of all triangles that share a vertex with an element, in
/// the order of the elements, and those of a node's elements. Parts of one surface touch only where their outsides face
/// each other, so most pairs of neighbours need no test (Volino and Magnenat-Thalmann 1994 use cones for it). In a
/// sheet this holds for neighbours only: rolled up, it meets itself with outsides that look the same way.
struct NormalBounds {
    std::vector<Bounds> vertices, elements, nodes;
    std::vector<Bounds> own; ///< each element's triangle alone
};

/// Computes the boxes from the current vertices.
void boundNormals(const CollisionSurface& surface, NormalBounds& out);

/// [-] Cosine: the tests of features allow for a degree, and floats are rounded.
inline constexpr float kAlmost = 0.05f;

/// Whether some normal of one box and some of the other differ by a right angle or more, or nearly so.
inline bool mayFace(const Bounds& a, const Bounds& b, float almost = kAlmost)
{
    const FourFloats highA = -a.negatedHigh, highB = -b.negatedHigh;
    const FourFloats p = a.low * b.low, q = a.low * highB, r = highA * b.low, s = highA * highB;
    const FourFloats pq = p < q ? p : q, rs = r < s ? r : s, least = pq < rs ? pq : rs;
    return least[0] + least[1] + least[2] < almost;
}

} // namespace filasofia::engine
