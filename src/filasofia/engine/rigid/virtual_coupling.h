#pragma once

#include "filasofia/engine/body/model.h"
#include "filasofia/engine/rigid/rigid_step.h"

/// Hands that hold rigid elements by a spring and a damper.
namespace filasofia::engine {

/// From now on it holds; where its coupling has neither spring nor damper, it lets go.
void hold(const Hand& hand, RigidState& state);

/// Adds a hand to what an element would do by itself in a step of dt [s]. Spring and damper are those of the step's end
/// (implicit Euler), so that no stiffness is too much for the step. `pose` is the element's at the start.
void planHand(const Hand& hand, const RigidModel& model, double dt, const Pose& pose, RigidPlanElement& planned);

/// Throws an Error naming what no step can be made with.
void checkHands(const std::string& object, const RigidModel& model, const RigidState& state);

} // namespace filasofia::engine
