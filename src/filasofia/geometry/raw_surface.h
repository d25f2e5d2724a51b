#pragma once

#include "filasofia/geometry/number_source.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <span>

namespace filasofia::geometry {

/// A surface as read from a file: points, and polygons that name them by their numbers from `first` on.
struct RawSurface {
    struct Polygon {
        std::int64_t number = 0;
        std::size_t place = 0; ///< as NumberSource::place()
        std::size_t begin = 0, count = 0;
    };
    std::vector<Vec3> points = {};
    std::vector<std::array<double, 2>> uv = {};          ///< one per point, or empty
    std::vector<std::array<double, 2>> uvOfCorners = {}; ///< in place of `uv`, if all polygons are triangles; or empty
    std::int64_t first = 0;
    std::vector<Polygon> polygons = {};
    std::vector<std::int64_t> corners = {}; ///< all polygons, one after the other
    std::size_t solids = 0;                 ///< that the file holds besides
    std::size_t secondOrder = 0;            ///< polygons of which only the corners were taken
    bool keepsUnused = false;               ///< points that no triangle has for a corner

    void add(std::span<const std::int64_t> polygon, std::int64_t number, std::size_t place);
};

/// Cuts the polygons into fans of triangles around their first corners. Triangles that name a point twice are dropped;
/// warnings count these and what else is left out. Errors name the line or byte.
TriangleMesh resolve(const RawSurface& raw, const NumberSource& file, std::string_view name);

} // namespace filasofia::geometry
