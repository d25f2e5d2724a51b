#pragma once

#include "filasofia/engine/articulation/joint_plan.h"
#include "filasofia/engine/rigid/rigid_step.h"

/// A step of articulated bodies (engine/articulation/joint_plan.h). Joints with a position command are kinematic:
/// contacts do not stop them. Joints with a force command are free, and so is the base of a dynamic body, whose six
/// degrees of freedom link_motion.h numbers after the joints. All links that a free joint moves are dynamic in the
/// plan.
namespace filasofia::engine {

/// The planned step of one articulated body.
struct ArticulationPlan {
    std::size_t body = 0;  ///< index in Scene::rigid
    std::size_t first = 0; ///< index of the base in the RigidPlan
    Pose baseEnd;          ///< pose of the base at the end of the step
    JointPlan joints;      ///< constraints add their changes to that of its step
};
using ArticulationPlans = std::vector<ArticulationPlan>; ///< in the order of bodies

/// Places the links by the positions of the joints. If another body carries the base, the base is placed first.
void placeLinks(std::size_t body, Scene& scene);

/// Plans a step of dt [s] >= 0 without constraints, after planRigid().
void planArticulations(const Scene& scene, double dt, RigidPlan& plan, ArticulationPlans& plans);

/// Sets the change of the free joints' velocities, and writes the resulting changes of the links to the plan.
void setChange(const LinkTree& tree, std::span<const double> change, ArticulationPlan& articulation, RigidPlan& plan);

/// Moves joints, bases and links as planned. A joint stops at its limits. If the new state is not finite or is beyond
/// physics::kFarthest, the joints stay where they are, at rest, and the report has StepFlag::Undone. If dt is 0, only
/// bases move, and their links with them.
void moveArticulations(const StepContext& context, const ArticulationPlans& plans, const RigidPlan& plan, Scene& scene);

} // namespace filasofia::engine
