#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <optional>

namespace filasofia::engine {

/// A point at the start and at the end of a step, in which it moves along a straight line.
struct MovedPoint {
    Vec3 from, to;
    [[nodiscard]] Vec3 at(double time) const { return from + time * (to - from); }
};
using MovedEdge = std::array<MovedPoint, 2>;
using MovedTriangle = std::array<MovedPoint, 3>;

/// Where two edges meet: `time` from 0 to 1 in the step, and the places along the edges, from 0 to 1.
struct EdgesMeet {
    double time = 0.0, first = 0.0, second = 0.0;
};
/// Where two edges first come `near` [m] or nearer to each other while they lie in one plane, if they do. Edges that
/// stay in one plane meet nowhere.
std::optional<EdgesMeet> firstMeeting(const MovedEdge& one, const MovedEdge& two, double near);

/// Where a point meets a triangle: `time` as above, and the place by its barycentric weights.
struct PointMeets {
    double time = 0.0;
    std::array<double, 3> weights{};
};
/// The same of a point and a triangle.
std::optional<PointMeets> firstMeeting(const MovedPoint& point, const MovedTriangle& triangle, double near);

} // namespace filasofia::engine
