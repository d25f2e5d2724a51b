#pragma once

#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <vector>

namespace filasofia::sofaengine {

/// A surface, for the choice of points near it or inside.
class NearSurface {
public:
    NearSurface(std::vector<Vec3> vertices, std::vector<geometry::Triangle> triangles);
    /// [m] The diagonal of its box.
    [[nodiscard]] double size() const;
    [[nodiscard]] double distance(Vec3 point) const; ///< [m]
    /// Whether a point is inside, or nearer than `within` [m].
    [[nodiscard]] bool has(Vec3 point, double within) const;

private:
    [[nodiscard]] bool isInside(Vec3 point) const;

    std::vector<Vec3> vertices_;
    std::vector<geometry::Triangle> triangles_;
    geometry::Bvh tree_;
};

} // namespace filasofia::sofaengine
