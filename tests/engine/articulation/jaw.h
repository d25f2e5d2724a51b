#pragma once

#include "filasofia/geometry/shapes.h"
#include "filasofia/math/world_inertia.h"

#include "engine/stage.h"

/// Helpers shared by the tests of articulated bodies.
namespace filasofia::engine {

inline constexpr double kArm = 0.03;        ///< [m] distance of the jaw's centre from the hinge
inline constexpr double kJawMass = 0.02;    ///< [kg]
inline constexpr double kJawInertia = 2e-6; ///< [kg m^2] about its centre

/// A base at the origin with a jaw on a hinge about z. At angle 0 the jaw points along x.
inline physics::RigidBodyDef jawBody(const physics::JointCommand& command)
{
    physics::JointDef hinge{.childOffset = {{-kArm, 0, 0}, {}}, .command = command};
    hinge.mass = physics::GivenInertia{.mass = kJawMass, .moments = {kJawInertia, kJawInertia, kJawInertia}};
    physics::RigidBodyDef def{.name = "jaw", .gravity = false};
    def.articulation.joints = {hinge};
    return def;
}

/// [kg m^2] Moment of inertia about the hinge.
inline constexpr double kHingeInertia = kJawInertia + kJawMass * kArm * kArm;

/// The same with a plate of 40 x 4 x 20 mm as collision model.
inline physics::RigidBodyDef touchingJaw(const physics::JointCommand& command)
{
    physics::RigidBodyDef def = jawBody(command);
    def.collision = {{.mesh = geometry::shapes::box({0.04, 0.004, 0.02}), .element = 1}};
    return def;
}

/// A cushion of tissue below the jaw, with its upper side at y = `top`, pinned at its lower side.
inline physics::SoftBodyDef cushion(double top)
{
    physics::SoftBodyDef def{.name = "cushion",
                             .mesh = shared(boxMesh({4, 3, 3}, {0.04, 0.02, 0.03})),
                             .material = physics::FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.4},
                             .gravity = false,
                             .collision = {{}}};
    def.pose.position = {0.012, top - 0.02, -0.015};
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, top - 0.0199, 1}}}};
    return def;
}

inline JointState& joint(Stage& stage, std::size_t body = 0, std::size_t j = 0)
{
    return stage.world.scene().rigid[body].state.joints[j];
}

/// [N m] Torque of all contacts on the body with that id about the z axis through the world's origin.
inline double contactTorque(Stage& stage, BodyId id)
{
    double sum = 0.0;
    for (const frame::Contact& each : stage.world.scene().contactReports) {
        if (each.first == id || each.second == id) sum += cross(each.point, forceOn(id, each)).z;
    }
    return sum;
}

} // namespace filasofia::engine
