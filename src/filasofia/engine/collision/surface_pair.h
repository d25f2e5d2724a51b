#pragma once

#include "filasofia/engine/collision/find_proximities.h"

#include <algorithm>
#include <cstdint>

namespace filasofia::engine {

/// Two surfaces whose boxes overlap, or one surface that may collide with itself.
struct SurfacePair {
    std::array<const CollisionSurface*, 2> sides{};
    std::array<int, 2> places{}; ///< indices in the list of surfaces
    double reach = 0.0;          ///< [s] one and a half steps
    /// [rad] By how much two rigid surfaces turn against each other in that time. What leads away from the other
    /// surface by less may lead towards it by then: a box that fell on an edge and tipped had a contact there alone,
    /// and its other edge was a millimetre deep before it had one.
    double turn = 0.0;

    [[nodiscard]] bool self() const { return places[0] == places[1]; }
    /// The closed surface of a solid against itself.
    [[nodiscard]] bool ownSolid() const { return self() && sides[0]->shape->closed && sides[0]->shape->triangleFaces; }
    [[nodiscard]] double proximities() const { return sides[0]->shape->proximity + sides[1]->shape->proximity; }
    [[nodiscard]] double depths() const { return sides[0]->shape->depth + sides[1]->shape->depth; }
};

inline std::uint64_t featureNumber(const SurfacePair& meeting, int first, int second)
{
    return featureNumber(FeaturePair{{meeting.sides[0]->name.model, meeting.sides[1]->name.model}, {first, second}});
}

/// A place on a surface by up to three vertices: a vertex, or a point on an edge or in a face.
struct Feature {
    std::array<int, 3> vertices{-1, -1, -1};
    std::array<double, 3> weights{};
    int number = 0;
};

/// The velocity of the place [m/s].
inline Vec3 velocityAt(const CollisionSurface& surface, const Feature& feature)
{
    Vec3 v;
    for (int k = 0; k < 3; ++k)
        if (feature.vertices[k] >= 0) v += feature.weights[k] * surface.v[feature.vertices[k]];
    return v;
}

/// Whether a triangle's plane has all of the other element, a triangle, a line or a point, on one side and farther away
/// than `far` [m].
inline bool planeSeparates(const CollisionSurface& a, const std::array<int, 3>& triangle, const CollisionSurface& b,
                           const std::array<int, 3>& other, double far)
{
    const Vec3 at = a.x[triangle[0]];
    const Vec3 normal = cross(a.x[triangle[1]] - at, a.x[triangle[2]] - at);
    const auto height = [&](int vertex) { return dot(normal, b.x[vertex] - at); };
    const double h0 = height(other[0]), h1 = other[1] < 0 ? h0 : height(other[1]),
                 h2 = other[2] < 0 ? h1 : height(other[2]);
    const double low = std::min(h0, std::min(h1, h2)), high = std::max(h0, std::max(h1, h2));
    const double gap = std::max(low, -high);
    return gap > 0.0 && gap * gap > far * far * lengthSquared(normal);
}

/// Whether two features of one surface are already near each other at rest.
bool nearAtRest(const SurfacePair& meeting, const std::array<int, 3>& a, const std::array<int, 3>& b);

} // namespace filasofia::engine
