#pragma once

#include "filasofia/engine/collision/find_proximities.h"

#include <algorithm>
#include <cstdint>
#include <span>

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
    std::span<const PushedFeatures> pushed = {};    ///< where their two bodies pushed each other in the last step
    const std::vector<Vec3>* edgeNormals = nullptr; ///< of a solid against itself: edgeNormal() of each edge

    [[nodiscard]] bool self() const { return places[0] == places[1]; }
    /// The closed surface of a solid against itself.
    [[nodiscard]] bool ownSolid() const { return self() && sides[0]->shape->closed && sides[0]->shape->triangleFaces; }
    [[nodiscard]] double proximities() const
    {
        if (self()) return 2.0 * sides[0]->shape->ownProximity;
        return sides[0]->shape->proximity + sides[1]->shape->proximity;
    }
    [[nodiscard]] double depths() const
    {
        if (self()) return 2.0 * sides[0]->shape->ownDepth();
        return sides[0]->shape->depth + sides[1]->shape->depth;
    }
};

inline std::uint64_t featureNumber(const SurfacePair& meeting, int first, int second)
{
    return featureNumber(FeaturePair{{meeting.sides[0]->name.model, meeting.sides[1]->name.model}, {first, second}});
}

/// The same for two edges. Those of one surface find each other in either order.
inline std::uint64_t edgesNumber(const SurfacePair& meeting, int first, int second)
{
    const int one = meeting.sides[0]->shape->edgeFeature(first), two = meeting.sides[1]->shape->edgeFeature(second);
    return meeting.self() && two < one ? featureNumber(meeting, two, one) : featureNumber(meeting, one, two);
}

/// Whether two edges pushed each other in the last step.
inline bool edgesPushed(const SurfacePair& meeting, int first, int second)
{
    return std::ranges::binary_search(meeting.pushed, edgesNumber(meeting, first, second), {},
                                      &PushedFeatures::feature);
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

/// Whether two features of one surface are already near each other at rest.
bool nearAtRest(const SurfacePair& meeting, const std::array<int, 3>& a, const std::array<int, 3>& b);

} // namespace filasofia::engine
