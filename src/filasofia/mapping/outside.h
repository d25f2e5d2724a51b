#pragma once

#include "filasofia/frame/boundary.h"
#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/embedding.h"

#include <array>
#include <optional>
#include <vector>

namespace filasofia::mapping {

/// A place on the outside of a body, at rest.
struct OutsidePlace {
    int triangle = -1; ///< of Outside
    Vec3 point = {};   ///< [m]
};

/// An edge of the rim of what was opened, at rest.
struct RimEdge {
    int triangle = -1; ///< of Outside: the one that it belongs to
    std::array<Vec3, 2> ends = {};
};

/// The boundary of a body without what cuts have opened, at rest: where something on the skin is, and which of its
/// parts still hang together.
class Outside {
public:
    /// The boundary outlives it.
    explicit Outside(const frame::Boundary& boundary);

    [[nodiscard]] int triangles() const { return static_cast<int>(places_.size()); }
    /// [m] Of all edges; 0 without any.
    [[nodiscard]] double meanEdge() const { return meanEdge_; }
    /// The nearest place; none where nothing is as near as `atMost` [m].
    [[nodiscard]] std::optional<OutsidePlace> nearest(Vec3 point, double atMost) const;
    /// A triangle of these three nodes, the smallest first and in its order.
    [[nodiscard]] bool has(const geometry::Triangle& nodes) const;
    [[nodiscard]] geometry::Triangle nodes(int triangle) const;

    /// Walks straight from one place to another, or towards one that is no longer there (triangle -1). None where it
    /// gets there: the two hang together, as far as their straight connection tells. Else where it came to the rim.
    [[nodiscard]] std::optional<RimEdge> rimBetween(const OutsidePlace& from, const OutsidePlace& to) const;

    /// The point rides on the tetrahedron behind the triangle.
    void embed(Vec3 point, int triangle, geometry::Embedding& embedding) const;

private:
    using Corners = std::array<Vec3, 3>;
    [[nodiscard]] const geometry::Triangle& of(int triangle) const { return boundary_.triangles[places_[triangle]]; }
    [[nodiscard]] Corners corners(int triangle) const;
    [[nodiscard]] Vec3 inwards(const OutsidePlace& place) const;

    const frame::Boundary& boundary_;
    std::vector<std::size_t> places_;            ///< in the boundary
    std::vector<std::array<int, 3>> neighbours_; ///< per triangle, across the edge opposite each corner; -1: the rim
    std::vector<geometry::Triangle> sorted_;     ///< nodes of all triangles, for has()
    geometry::Bvh tree_;
    double meanEdge_ = 0.0;
};

} // namespace filasofia::mapping
