#pragma once

#include "filasofia/frame/boundary.h"
#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/embedding.h"

#include <array>
#include <optional>
#include <vector>

namespace filasofia::mapping {

/// The mean of three vectors with weights of sum 1.
inline Vec3 mean(const std::array<Vec3, 3>& corners, const std::array<double, 3>& weights)
{
    return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

/// A position on the outside of a body, at rest.
struct OutsidePlace {
    int triangle = -1; ///< index of a triangle of Outside
    Vec3 point = {};   ///< [m]
};

/// An edge of the rim of an opening, at rest.
struct RimEdge {
    int triangle = -1; ///< index of the triangle of Outside that it belongs to
    std::array<Vec3, 2> ends = {};
};

/// The boundary of a body without what cuts have opened, at rest. It finds positions on the skin, and which of its
/// parts are still connected.
class Outside {
public:
    /// The boundary must outlive it.
    explicit Outside(const frame::Boundary& boundary);

    [[nodiscard]] int triangles() const { return static_cast<int>(places_.size()); }
    /// [m] mean length of all edges; 0 if there are none.
    [[nodiscard]] double meanEdge() const { return meanEdge_; }
    /// The nearest position; nullopt if nothing is as near as `atMost` [m].
    [[nodiscard]] std::optional<OutsidePlace> nearest(Vec3 point, double atMost) const;
    /// Whether there is a triangle of these three nodes, in this cyclic order with the smallest first.
    [[nodiscard]] bool has(const geometry::Triangle& nodes) const;
    [[nodiscard]] geometry::Triangle nodes(int triangle) const;

    /// Walks straight from one position to another, or towards one that no longer exists (triangle -1). Returns nullopt
    /// if it arrives: the two are connected, as far as the straight line between them tells. Otherwise returns the edge
    /// where it reached the rim.
    [[nodiscard]] std::optional<RimEdge> rimBetween(const OutsidePlace& from, const OutsidePlace& to) const;

    /// Embeds the point in the tetrahedron behind the triangle.
    void embed(Vec3 point, int triangle, geometry::Embedding& embedding) const;

private:
    using Corners = std::array<Vec3, 3>;
    [[nodiscard]] const geometry::Triangle& of(int triangle) const { return boundary_.triangles[places_[triangle]]; }
    [[nodiscard]] Corners corners(int triangle) const;
    [[nodiscard]] Vec3 inwards(const OutsidePlace& place) const;

    const frame::Boundary& boundary_;
    std::vector<std::size_t> places_; ///< indices in the boundary
    std::vector<std::array<int, 3>>
        neighbours_; ///< per triangle, the neighbour across the edge opposite each corner; -1 at the rim
    std::vector<geometry::Triangle> sorted_; ///< nodes of all triangles, for has()
    geometry::Bvh tree_;
    double meanEdge_ = 0.0;
};

} // namespace filasofia::mapping
