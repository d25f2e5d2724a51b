#include "filasofia/sofa/near_surface.h"

#include "filasofia/geometry/distance.h"
#include "filasofia/geometry/solid_angle.h"

#include <cmath>

namespace filasofia::sofaengine {

using geometry::Triangle;

NearSurface::NearSurface(std::vector<Vec3> vertices, std::vector<Triangle> triangles)
    : vertices_(std::move(vertices)), triangles_(std::move(triangles))
{
    std::vector<geometry::Box> boxes;
    for (const Triangle& t : triangles_) {
        geometry::Box& box = boxes.emplace_back();
        for (const int corner : t) box = geometry::merged(box, vertices_[static_cast<std::size_t>(corner)]);
    }
    tree_ = geometry::Bvh(boxes);
}

double NearSurface::size() const
{
    const geometry::Box box = tree_.bounds();
    return length(box.high - box.low);
}

double NearSurface::distance(Vec3 point) const
{
    const auto squaredDistance = [&](int t) {
        const auto [a, b, c] = triangles_[static_cast<std::size_t>(t)];
        const auto at = [&](int corner) { return vertices_[static_cast<std::size_t>(corner)]; };
        return geometry::nearestOnTriangle(point, at(a), at(b), at(c)).squaredDistance;
    };
    return std::sqrt(tree_.nearest(point, squaredDistance).value);
}

bool NearSurface::has(Vec3 point, double within) const
{
    if (distance(point) <= within) return true;
    return geometry::squaredDistance(tree_.bounds(), point) == 0.0 && isInside(point);
}

/// By the solid angle of the surface: 4 pi around a point inside, 0 outside.
bool NearSurface::isInside(Vec3 point) const
{
    double angle = 0.0;
    const auto at = [&](int corner) { return vertices_[static_cast<std::size_t>(corner)]; };
    for (const auto& [a, b, c] : triangles_) angle += geometry::solidAngle(point, at(a), at(b), at(c));
    return std::abs(angle) > 2.0 * M_PI;
}

} // namespace filasofia::sofaengine
