#pragma once

#include "filasofia/math/pose.h"
#include "filasofia/physics/articulation_def.h"
#include "filasofia/physics/attachment_def.h"
#include "filasofia/physics/collision_def.h"
#include "filasofia/physics/mass_def.h"
#include "filasofia/physics/needle_def.h"

namespace filasofia::physics {

/// [m], [m/s]: nothing may be placed farther out, and a state that gets there counts as a blow-up. Rendering computes
/// in float, and surfaces embedded in a body extrapolate: this bound keeps both far from overflow.
inline constexpr double kFarthest = 1e4;

/// A body of one or more elements that do not deform.
struct RigidBodyDef {
    std::string name = "rigid body";
    /// one pose per element, at least one; with joints the base alone is enough. Assign it: push_back() adds to the one
    /// that is there
    std::vector<Pose> elements = {Pose{}};
    /// its surface, the same for every element, in the element's coordinates; needed by collision models without a mesh
    /// of their own, and by a mass that is not given
    TriangleMeshSource mesh = {};
    bool dynamic =
        false; ///< moved by forces; otherwise kinematic: its motion is prescribed (setPose), whatever is in its way
    RigidMass mass = Density{}; ///< inertia of each element of a dynamic body; Density and TotalMass need a closed mesh
    Vec3 velocity = {}; ///< [m/s], initial, of a dynamic body's elements (with joints: that of its base's origin)
    Vec3 angularVelocity = {};                ///< [rad/s], the same, in world axes
    double linearDamping = 0.0;               ///< [1/s], >= 0, damping of a dynamic body's velocity
    double angularDamping = 0.0;              ///< [1/s], >= 0, damping of its angular velocity
    bool gravity = true;                      ///< whether gravity acts on it
    std::vector<CollisionDef> collision = {}; ///< its collision models; none: it collides with nothing
    double friction = 0.3; ///< [-], >= 0, Coulomb's mu; a pair of bodies uses the square root of the product of both
    std::vector<RigidAttachmentDef> attachments = {}; ///< attachments of its elements
    ArticulationDef articulation = {};                ///< joints between its elements
    std::optional<NeedleDef> needle = {};             ///< none: it pierces nothing
};

constexpr auto fields(const RigidBodyDef*)
{
    using T = RigidBodyDef;
    return describe(
        "RigidBodyDef", field("name", &T::name, "its name in errors and reports"),
        field("elements", &T::elements, "one pose per element"),
        field("mesh", &T::mesh, "its surface, or the file of its surface"),
        field("dynamic", &T::dynamic, "moved by forces; otherwise kinematic"),
        field("mass", &T::mass, "density, total mass, or inertia"),
        field("velocity", &T::velocity, "m/s", finite(), "initial velocity"),
        field("angularVelocity", &T::angularVelocity, "rad/s", finite(), "initial angular velocity"),
        field("linearDamping", &T::linearDamping, "1/s", within(nonNegative(), 1e9), "damping of its velocity"),
        field("angularDamping", &T::angularDamping, "1/s", within(nonNegative(), 1e9),
              "damping of its angular velocity"),
        field("gravity", &T::gravity, "whether gravity acts on it"),
        field("collision", &T::collision, "its collision models"),
        field("friction", &T::friction, "-", within(nonNegative(), kLargestFriction),
              "friction coefficient mu of Coulomb's law"),
        field("attachments", &T::attachments, "attachments of its elements"),
        field("articulation", &T::articulation, "joints between its elements"),
        field("needle", &T::needle, "its needle; none: it pierces nothing"));
}

} // namespace filasofia::physics
