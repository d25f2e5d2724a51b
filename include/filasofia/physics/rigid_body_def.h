#pragma once

#include "filasofia/math/pose.h"
#include "filasofia/physics/articulation_def.h"
#include "filasofia/physics/attachment_def.h"
#include "filasofia/physics/collision_def.h"
#include "filasofia/physics/mass_def.h"

namespace filasofia::physics {

/// [m], [m/s]: nothing may be placed farther out, and a state that gets there is a blow-up. A picture computes in
/// float, and surfaces that ride on a body extrapolate: both stay far from overflow.
inline constexpr double kFarthest = 1e4;

/// A body of one or more elements that do not deform.
struct RigidBodyDef {
    std::string name = "rigid body";
    std::vector<Pose> elements = {Pose{}}; ///< one pose per element, at least one; with joints the base alone will do
    TriangleMeshSource mesh = {}; ///< its surface, the same for every element, in the element's coordinates; needed by
                                  ///< collision models without a mesh of their own, and by a mass that is not given
    bool dynamic = false;         ///< moved by forces; else it goes where it is told (setPose), whatever is in its way
    RigidMass mass = Density{};   ///< of each element of a dynamic body; Density and TotalMass need a closed mesh
    Vec3 velocity = {};           ///< [m/s], of a dynamic body's elements at the start (with joints: its base's origin)
    Vec3 angularVelocity = {};    ///< [rad/s], the same, in world axes
    double linearDamping = 0.0;   ///< [1/s], >= 0, of a dynamic body: slows it down by itself
    double angularDamping = 0.0;  ///< [1/s], >= 0, the same of its turning
    bool gravity = true;          ///< does gravity act on it
    std::vector<CollisionDef> collision = {}; ///< by what it is touched; none: nothing touches it
    double friction = 0.3; ///< [-], >= 0, mu; two bodies that touch have the root of the product of theirs
    std::vector<RigidAttachmentDef> attachments = {}; ///< what holds it
    ArticulationDef articulation = {};                ///< joints between its elements
};

constexpr auto fields(const RigidBodyDef*)
{
    using T = RigidBodyDef;
    return describe("RigidBodyDef", field("name", &T::name, "what errors and reports call it"),
                    field("elements", &T::elements, "one pose per element"),
                    field("mesh", &T::mesh, "its surface's file, or the surface"),
                    field("dynamic", &T::dynamic, "moved by forces"),
                    field("mass", &T::mass, "density, total mass, or inertia"),
                    field("velocity", &T::velocity, "m/s", finite(), "at the start"),
                    field("angularVelocity", &T::angularVelocity, "rad/s", finite(), "at the start"),
                    field("linearDamping", &T::linearDamping, "1/s", nonNegative(), "of its motion"),
                    field("angularDamping", &T::angularDamping, "1/s", nonNegative(), "of its turning"),
                    field("gravity", &T::gravity, "does gravity act on it"),
                    field("collision", &T::collision, "by what it is touched"),
                    field("friction", &T::friction, "-", nonNegative(), "mu of Coulomb's law"),
                    field("attachments", &T::attachments, "what holds it"),
                    field("articulation", &T::articulation, "joints between its elements"));
}

} // namespace filasofia::physics
