#pragma once

#include "filasofia/geometry/texture_seams.h"
#include "filasofia/mapping/map.h"

#include <array>
#include <vector>

namespace filasofia::mapping {

/// What is printed on a sheet, by texture coordinates of its vertices at rest, and stays on it when it is cut: a node
/// that a cut makes or moves gets those of its place at rest.
class PrintedSheet {
public:
    /// `rest` is the sheet before it is cut, with texture coordinates; its vertices are the body's nodes. A seam
    /// has the texture coordinates of one side.
    explicit PrintedSheet(geometry::TriangleMesh rest) : rest_(std::move(rest)) { rest_.uv = uvOfVertices(rest_); }

    /// Gives texture coordinates to a surface whose vertices are nodes of the body at rest. Nodes that it has seen at
    /// the same place cost nothing.
    void print(MappedSurface& surface);

private:
    struct Known {
        Vec3 place = {};
        std::array<double, 2> uv = {};
        bool there = false;
    };
    [[nodiscard]] std::array<double, 2> at(Vec3 place) const;

    geometry::TriangleMesh rest_;
    std::vector<Known> known_; ///< per node
};

} // namespace filasofia::mapping
