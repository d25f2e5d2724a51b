#pragma once

#include "filasofia/engine/integration/rigid.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"
#include "filasofia/physics/step.h"

/// A step of the rigid bodies in two halves: planRigid() plans it without constraints, constraints change the plan, and
/// moveRigid() carries it out.
namespace filasofia::engine {

/// The step of one element. If it is kinematic, mass, inertia and change are zero.
struct RigidPlanElement {
    std::size_t body = 0; ///< index in Scene::rigid
    std::size_t element = 0;
    bool dynamic = false;
    Pose start;           ///< pose at the start of the step
    double mass = 0.0;    ///< [kg]
    Mat3 inertia;         ///< [kg m^2] in world axes, at the start of the step
    Vec3 centre;          ///< [m] in the world, at the start: centre of mass; the origin if the element is a link
                          ///< or kinematic
    Vec3 velocity;        ///< [m/s] velocity of `centre` at the start; throughout the step if kinematic
    Vec3 angularVelocity; ///< [rad/s] the same
    Vec3 beyond; ///< [m/s] links that joints carry along an arc: mean velocity of `centre` in the step, less the
                 ///< velocity that it has at the start
    double couplingMass = 0.0;    ///< [kg] mass that an implicit virtual coupling adds against impulses
    double couplingInertia = 0.0; ///< [kg m^2] the same about any axis
    Mat3 heldInertia = {};        ///< [kg m^2] the same in world axes by what the element is attached to
    RigidChange change;           ///< the element moves with velocity + change through the step; constraints add theirs
    int articulation = -1;        ///< links: index of the body's ArticulationPlan (articulation_step.h); -1: not a link
    std::size_t base = 0;         ///< links: index of the body's first element in the plan
};
using RigidPlan = std::vector<RigidPlanElement>; ///< in the order of bodies and elements

/// The index in the plan of each body's first element.
std::vector<std::size_t> firstElements(const Scene& scene);

/// Sets the constant velocities that lead from the start of the element to `end` in dt [s]; leaves them unchanged if dt
/// is 0 or the motion would be a jump (physics::kTeleport, kTeleportTurn).
void planPrescribedMotion(const Pose& end, double dt, RigidPlanElement& out);

/// Plans a step of dt [s] >= 0 without constraints. Links are left at rest, for planArticulations(). If a kinematic
/// element would move faster than physics::kTeleport or turn by more than kTeleportTurn, the motion is a jump and has
/// no velocity.
void planRigid(const Scene& scene, double dt, RigidPlan& plan);

/// Moves every dynamic element as planned, and kinematic ones exactly to their targets. If the new state of a dynamic
/// element is not finite or is beyond physics::kFarthest, the element stays where it is, at rest, and the report has
/// StepFlag::Undone. If dt is 0, only kinematic elements move. Links are left to moveArticulations().
void moveRigid(const StepContext& context, const RigidPlan& plan, Scene& scene);

} // namespace filasofia::engine
