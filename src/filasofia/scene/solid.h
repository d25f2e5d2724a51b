#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/math/pose.h"
#include "filasofia/physics/defs.h"
#include "filasofia/visual/material.h"

#include <memory>
#include <optional>

/// The shapes of robots and models: their surfaces, and what they weigh.
namespace filasofia::scene {

/// A shape in its own coordinates. Long ones lie along z.
struct Solid {
    enum class Kind { Box, Sphere, Capsule, Cylinder, Ellipsoid, Mesh };
    Kind kind = Kind::Box;
    Vec3 half = {}; ///< [m], half of its size along each axis; a capsule's half length is that of the line inside
    std::shared_ptr<const geometry::TriangleMesh> mesh = {}; ///< if it is one
};

/// Its surface, moved to `pose`.
std::shared_ptr<const geometry::TriangleMesh> surfaceOf(const Solid& solid, const Pose& pose);

/// The mesh, scaled along each axis; turned right side out if the scales mirror it.
std::shared_ptr<const geometry::TriangleMesh> scaled(const geometry::TriangleMesh& mesh, Vec3 scale);

/// Its volume [m^3]. Throws an Error that begins with `name` for a mesh that has no inside.
double volumeOf(const Solid& solid, std::string_view name);

/// Its inertia if it weighs `mass` [kg], in its own coordinates.
physics::RigidInertia inertiaOf(const Solid& solid, double mass, std::string_view name);

/// An inertia as seen from the coordinates that `pose` maps its own to.
physics::RigidInertia moved(const Pose& pose, const physics::RigidInertia& inertia);

/// Both together, about their common centre.
physics::RigidInertia sumOf(const physics::RigidInertia& a, const physics::RigidInertia& b);

/// By its principal axes; an inertia tensor that is diagonal keeps its axes and its bits. Nothing if no body has it: a
/// moment is not positive, or larger than the sum of the other two.
std::optional<physics::GivenInertia> principal(const physics::RigidInertia& inertia);

/// A surface of one colour, given in sRGB as pictures are.
visual::Material plainMaterial(Vec3 rgb);

} // namespace filasofia::scene
