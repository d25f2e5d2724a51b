#pragma once

#include "filasofia/surface/film.h"

namespace filasofia::surface {

/// What byNode() says of a node that is not on the surface.
inline constexpr float kNoSurface = -2.0F;

/// The surface of a soft body, by those of its nodes that lie on it. Vertices are local: 0, 1, ..., ascending by their
/// nodes. When the body is cut the numbers of vertices change, and those of nodes keep their meaning.
class BodySurface {
public:
    struct Change {
        std::vector<int> now = {};   ///< per former vertex, its number now; -1 if it is no longer on the surface
        std::vector<int> fresh = {}; ///< vertices that were not there before, ascending
    };
    /// `triangles` by the body's nodes.
    Change set(std::vector<geometry::Triangle> triangles);

    [[nodiscard]] const FilmTopology& topology() const { return topology_; }
    [[nodiscard]] const std::vector<int>& nodes() const { return nodes_; } ///< of each vertex, ascending
    [[nodiscard]] std::size_t vertices() const { return nodes_.size(); }
    /// The number of nodes that positions must have.
    [[nodiscard]] int nodesNeeded() const { return nodes_.empty() ? 0 : nodes_.back() + 1; }
    /// Places of the vertices [m] from positions of the nodes.
    void gather(std::span<const Vec3> positions, std::vector<Vec3>& places) const;
    /// Values per node of the body from values per vertex; kNoSurface where there is none.
    [[nodiscard]] std::vector<float> byNode(std::span<const double> values) const;

private:
    std::vector<int> nodes_;
    FilmTopology topology_;
};

} // namespace filasofia::surface
