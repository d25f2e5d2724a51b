#pragma once

#include "filasofia/math/vec3.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

namespace filasofia::geometry {

/// An axis-aligned box; a default-constructed one is empty and contains no point.
struct Box {
    Vec3 low{kFar, kFar, kFar};     ///< [m]
    Vec3 high{-kFar, -kFar, -kFar}; ///< [m]

    static constexpr double kFar = std::numeric_limits<double>::infinity();
    friend constexpr bool operator==(const Box&, const Box&) = default;
};

/// Also true if a coordinate is NaN.
constexpr bool isEmpty(const Box& a) { return !(a.low.x <= a.high.x && a.low.y <= a.high.y && a.low.z <= a.high.z); }

/// The smallest box around both.
constexpr Box merged(const Box& a, const Box& b) { return {min(a.low, b.low), max(a.high, b.high)}; }
constexpr Box merged(const Box& a, Vec3 p) { return {min(a.low, p), max(a.high, p)}; }

/// The smallest box around all points; empty if there are none.
constexpr Box boxAround(std::span<const Vec3> points)
{
    Box box;
    for (const Vec3& point : points) box = merged(box, point);
    return box;
}

/// The box with `margin` [m] added on every side.
constexpr Box grown(const Box& a, double margin)
{
    const Vec3 m{margin, margin, margin};
    return {a.low - m, a.high + m};
}

/// Also true if the boxes only touch.
constexpr bool overlap(const Box& a, const Box& b)
{
    return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
           a.low.z <= b.high.z && b.low.z <= a.high.z;
}

/// [m^2], 0 inside the box; infinite for an empty box.
constexpr double squaredDistance(const Box& a, Vec3 p)
{
    return lengthSquared(max(max(a.low - p, p - a.high), Vec3{}));
}

/// Whether a point is in the box or on its border.
constexpr bool contains(const Box& a, Vec3 p) { return squaredDistance(a, p) == 0.0; }

/// How much [m] of a straight way lies in a box.
inline double lengthWithin(const Box& box, Vec3 from, Vec3 to)
{
    const Vec3 way = to - from;
    double begin = 0.0, end = 1.0;
    const std::array<std::array<double, 4>, 3> axes{{{from.x, way.x, box.low.x, box.high.x},
                                                     {from.y, way.y, box.low.y, box.high.y},
                                                     {from.z, way.z, box.low.z, box.high.z}}};
    for (const auto& [at, along, low, high] : axes) {
        if (along == 0.0) {
            if (at < low || at > high) return 0.0;
            continue;
        }
        const double a = (low - at) / along, b = (high - at) / along;
        begin = std::max(begin, std::min(a, b));
        end = std::min(end, std::max(a, b));
    }
    return std::max(end - begin, 0.0) * length(way);
}

constexpr auto fields(const Box*)
{
    return describe("Box", field("low", &Box::low, "m", finite(), "lower corner"),
                    field("high", &Box::high, "m", finite(), "upper corner"));
}

} // namespace filasofia::geometry
