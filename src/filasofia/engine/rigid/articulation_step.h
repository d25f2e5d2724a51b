#pragma once

#include "filasofia/engine/articulation/link_motion.h"
#include "filasofia/engine/rigid/rigid_step.h"

/// A step of articulated bodies. Joints that a position commands go there, and their links are in nobody's way. Joints
/// that a force commands are free, and the base of a dynamic body is (link_motion.h numbers it with the joints): their
/// velocities are the unknowns of the body,
///
///     (M + h D) dq' = h (force - D q' - c(q, q', base)) + sum of J^T impulse,
///
/// semi-implicit Euler in reduced coordinates; all links that a free joint moves are dynamic in the plan.
namespace filasofia::engine {

struct ArticulationPlan {
    std::size_t body = 0;           ///< place in the model
    std::size_t first = 0;          ///< the base's place in the plan
    Pose baseEnd;                   ///< at the end of the step
    std::vector<JointAxis> axes;    ///< at the start
    std::vector<double> velocities; ///< [rad/s] or [m/s]: throughout the step; of a free joint at its start; those of a
                                    ///< free base follow
    std::vector<int> free;          ///< joints, ascending
    std::vector<int> place;         ///< per joint: among the free ones; -1: it is not free
    bool freeBase = false;          ///< its six joints are the last of the free ones
    std::vector<double> arms;       ///< [m] per free joint: what makes a velocity [m/s] of its own
    JointMatrix matrix;             ///< M + h D of the free joints
    JointMatrix inverse;            ///< of the matrix
    std::vector<double> change;     ///< of the free joints' velocities: contacts add theirs here
};
using ArticulationPlans = std::vector<ArticulationPlan>; ///< in the order of bodies

/// Puts the links where the joints say, and the base of a body that another takes along where that is.
void placeLinks(std::size_t body, Scene& scene);

/// After planRigid(): what a step of dt [s] >= 0 would be without contacts.
void planArticulations(const Scene& scene, double dt, RigidPlan& plan, ArticulationPlans& plans);

/// Takes a change of the free joints' velocities, and writes what it does to the links.
void setChange(const LinkTree& tree, std::span<const double> change, ArticulationPlan& articulation, RigidPlan& plan);

/// Moves joints, bases and links as planned. A joint stops at its limits. Where the new state is not finite, or beyond
/// physics::kFarthest, the joints stay where they are, at rest, and the report has StepFlag::Undone. With dt = 0 only
/// bases move.
void moveArticulations(const StepContext& context, const ArticulationPlans& plans, const RigidPlan& plan, Scene& scene);

} // namespace filasofia::engine
