#pragma once

#include "filasofia/math/pose.h"
#include "filasofia/runtime/show.h"

#include <array>

namespace filasofia::runtime {

/// An element of a rigid body.
struct FollowElement {
    int element = 0; ///< [-], >= 0, < the number of elements
};
constexpr auto fields(const FollowElement*)
{
    return describe("FollowElement",
                    field("element", &FollowElement::element, "-", nonNegative(), "index in a rigid body"));
}

/// The point of a soft body's surface that is nearest to a place at rest.
struct FollowNearest {
    Vec3 place = {};            ///< [m], at rest, in the body's coordinates
    SurfaceSource surface = {}; ///< in the body's coordinates; empty: the body's boundary
};
constexpr auto fields(const FollowNearest*)
{
    using T = FollowNearest;
    return describe("FollowNearest", field("place", &T::place, "m", finite(), "at rest, in the body's coordinates"),
                    field("surface", &T::surface, "a surface file, or the surface"));
}

/// A point of a triangle of a soft body's surface.
struct FollowTriangle {
    int triangle = 0;                                ///< [-], >= 0, < the number of triangles
    std::array<double, 3> weights = {1.0, 0.0, 0.0}; ///< [-], each in [0, 1], barycentric; their sum is 1
    SurfaceSource surface = {};                      ///< in the body's coordinates; empty: the body's boundary
};
constexpr auto fields(const FollowTriangle*)
{
    using T = FollowTriangle;
    return describe("FollowTriangle", field("triangle", &T::triangle, "-", nonNegative(), "index in the surface"),
                    field("weights", &T::weights, "-", closed(0, 1), "barycentric weights"),
                    field("surface", &T::surface, "a surface file, or the surface"));
}

/// The place of a body that a visual Transform follows, and the offset from it.
struct FollowDef {
    std::variant<FollowElement, FollowNearest, FollowTriangle> at = FollowElement{};
    /// Pose relative to the element or, on a surface, relative to a frame whose +Z points out of it and whose +Y at
    /// rest is as near to the world's as possible. A camera or lamp looks along -Z, so without an offset it looks into
    /// the surface.
    Pose offset = {};
};
constexpr auto fields(const FollowDef*)
{
    return describe("FollowDef", field("at", &FollowDef::at, "what it follows"),
                    field("offset", &FollowDef::offset, "offset from there"));
}

} // namespace filasofia::runtime
