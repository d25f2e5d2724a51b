#pragma once

#include "filasofia/engine/rigid/rigid_step.h"
#include "filasofia/engine/scene/scene.h"

/// Hands that hold rigid elements by a spring and a damper.
namespace filasofia::engine {

/// From now on it holds; where its coupling has neither spring nor damper, it lets go.
void hold(const Hand& hand, RigidState& state);

/// Adds a hand to what an element would do by itself in a step of dt [s]. Spring and damper are those of the step's end
/// (implicit Euler), so that no stiffness is too much for the step. `pose` is the element's at the start.
void planHand(const Hand& hand, const RigidModel& model, double dt, const Pose& pose, RigidPlanElement& planned);

} // namespace filasofia::engine
