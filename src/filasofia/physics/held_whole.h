#pragma once

#include "filasofia/geometry/box.h"
#include "filasofia/physics/defs.h"

#include <cmath>
#include <vector>

/// A rigid element that is attached as a whole: four points of it are.
namespace filasofia::physics {

/// [m] Radius of gyration of a rigid element, from its centre of mass; a guess for one without mass, 0 for one that has
/// no surface either.
inline double gyration(const RigidInertia& body, const geometry::TriangleMesh* surface)
{
    if (body.mass > 0.0) return std::sqrt(0.5 * trace(body.inertia) / body.mass);
    if (!surface) return 0.0;
    const geometry::Box box = geometry::boxAround(surface->vertices);
    return 0.25 * length(box.high - box.low);
}

/// Four points around a centre of mass, not in one plane: attaching them fixes both position and orientation.
inline std::vector<Vec3> pointsAround(Vec3 centre, double radius)
{
    const double r = radius / std::sqrt(3.0);
    return {centre + Vec3{r, r, r}, centre + Vec3{r, -r, -r}, centre + Vec3{-r, r, -r}, centre + Vec3{-r, -r, r}};
}

} // namespace filasofia::physics
