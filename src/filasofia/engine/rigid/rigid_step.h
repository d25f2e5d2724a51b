#pragma once

#include "filasofia/engine/integration/rigid.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"
#include "filasofia/physics/step.h"

/// A step of the rigid bodies, in two halves between which contacts may change what the first has planned.
namespace filasofia::engine {

/// One element's step. Where it is not dynamic, mass and inertia are zero, and so is the change.
struct RigidPlanElement {
    std::size_t body = 0; ///< place in the model
    std::size_t element = 0;
    bool dynamic = false;
    Pose start;               ///< at the start of the step
    double mass = 0.0;        ///< [kg]
    Mat3 inertia;             ///< [kg m^2] in world axes, at the start of the step
    Vec3 centre;              ///< [m] in the world, at the start: of mass; the origin of a link, and of one that is not
                              ///< dynamic
    Vec3 velocity;            ///< [m/s] of the centre: at the start; of one that is not dynamic, throughout the step
    Vec3 angularVelocity;     ///< [rad/s] the same
    double heldMass = 0.0;    ///< [kg] that a hand's spring and damper add against impulses, as they are implicit
    double heldInertia = 0.0; ///< [kg m^2] the same about any axis
    RigidChange change;       ///< the element moves through the step with velocity + change: contacts add theirs here
    int articulation = -1; ///< of a link: its body's place among the articulations (articulation_step.h), which plan it
    std::size_t base = 0;  ///< of a link: the place of its body's first element in the plan
};
using RigidPlan = std::vector<RigidPlanElement>; ///< in the order of bodies and elements

/// The place in the plan of each body's first element.
std::vector<std::size_t> firstElements(const Scene& scene);

/// Constant velocities that lead from where the element is to `end`; none where that would be a jump.
void planWay(const Pose& end, double dt, RigidPlanElement& out);

/// What a step of dt [s] >= 0 would be without contacts. Links are left at rest, for planArticulations(). A jump of an
/// element that goes where it is told has no velocity when it would be faster than kTeleport, or turn by more than
/// kTeleportTurn.
void planRigid(const Scene& scene, double dt, RigidPlan& plan);
inline constexpr double kTeleport = 20.0;    ///< [m/s]
inline constexpr double kTeleportTurn = 1.0; ///< [rad] in one step

/// Moves every element as planned, and those that go where they are told to exactly there. A dynamic element whose new
/// state is not finite, or beyond physics::kFarthest, stays where it is, at rest, and the report has
/// StepFlag::Undone. With dt = 0 only what was told happens. Links are left alone.
void moveRigid(const StepContext& context, const RigidPlan& plan, Scene& scene);

} // namespace filasofia::engine
