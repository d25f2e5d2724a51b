#pragma once

#include "filasofia/math/rounded.h"
#include "filasofia/runtime/simulation.h"

#include <cmath>

/// The outer end of a shaft, as a body that a haptic device holds.
namespace filasofia::prefab {

inline constexpr double kHandleForceLimit = 20.0; ///< [N], largest force on it: a tool that hands drive never yields

/// Adds it: 0.15 kg, an instrument or a scope with its camera as far as a hand feels it, with the inertia of a ball.
inline BodyId addHandleBody(runtime::Simulation& simulation, const std::string& name, const Pose& pose)
{
    constexpr double mass = 0.15, radius = 0.02, inertia = 0.4 * mass * radius * radius;
    return simulation.add(
        physics::RigidBodyDef{.name = name,
                              .elements = {pose},
                              .dynamic = true,
                              .mass = physics::GivenInertia{.mass = mass, .moments = {inertia, inertia, inertia}},
                              .angularDamping = 5.0,
                              .gravity = false});
}

/// [rad], rotation of `turned` relative to `base` about its Z.
inline double rollBetween(Quat base, Quat turned)
{
    const Quat relative = conjugate(base) * turned;
    return 2.0 * std::atan2(relative.z, relative.w);
}

/// Pushes it until the next step, with numbers short enough for recordings.
inline void pushHandleBody(runtime::Simulation& simulation, BodyId body, Vec3 force, Vec3 torque)
{
    constexpr double kForces = 1e5, kTorques = 1e7; // rounds to 1e-5 N and 1e-7 N m
    simulation.physics().setWrench(body, rounded(limitFactor(length(force), kHandleForceLimit) * force, kForces),
                                   rounded(torque, kTorques));
}

} // namespace filasofia::prefab
