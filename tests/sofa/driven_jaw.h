#pragma once

#include "sofa/sofa_stage.h"

#include "filasofia/geometry/shapes.h"

#include <numbers>

/// A jaw that forces move, on either engine.
namespace filasofia::driven_jaw {

using namespace physics;
using namespace sofa_test;

inline constexpr double kG = 9.81, kDt = 1e-3, kPi = std::numbers::pi;
inline constexpr double kArm = 0.03;                                  // [m] from the hinge to the jaw's centre
inline constexpr double kMass = 0.02;                                 // [kg]
inline constexpr double kInertia = 2e-6;                              // [kg m^2] about its centre
inline constexpr double kAboutHinge = kInertia + kMass * kArm * kArm; // [kg m^2]

/// A jaw on a hinge about z at the origin. At angle 0 it points along x.
inline RigidBodyDef jaw(const JointCommand& command, double start = 0.0)
{
    JointDef hinge{.childOffset = {{-kArm, 0, 0}, {}}, .start = start, .command = command};
    hinge.mass = GivenInertia{.mass = kMass, .moments = {kInertia, kInertia, kInertia}};
    RigidBodyDef def{.name = "jaw"};
    def.articulation.joints = {hinge};
    return def;
}
/// The same with a plate of 40 x 4 x 20 mm.
inline RigidBodyDef plate(const JointCommand& command, double start = 0.0)
{
    RigidBodyDef def = jaw(command, start);
    def.collision = {{.mesh = geometry::shapes::box({0.04, 0.004, 0.02}), .element = 1}};
    return def;
}
/// The same on a free base of 50 g, which turns with a skew axis.
inline RigidBodyDef freeTool(const JointCommand& command)
{
    RigidBodyDef def = jaw(command);
    def.articulation.joints[0].axis = {0.3, 0.5, 1.0};
    def.dynamic = true;
    def.mass = GivenInertia{.mass = 0.05, .centre = {-0.01, 0.002, 0.001}, .moments = {2e-5, 3e-5, 4e-5}};
    return def;
}
inline frame::Joint joint(PhysicsServer& server, BodyId body, std::size_t j = 0)
{
    return server.latest()->rigidBody(body)->joints[j];
}

} // namespace filasofia::driven_jaw
