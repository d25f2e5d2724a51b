#pragma once

#include "filasofia/engine/rigid/rigid_step.h"
#include "filasofia/engine/scene/scene.h"

/// Virtual couplings (Colgate): a spring and a damper between a haptic target and an element of a rigid body.
namespace filasofia::engine {

/// Adds or replaces the virtual coupling of an element. If it has neither spring nor damper, the element's coupling is
/// removed.
void hold(const Hand& hand, RigidState& state);

/// Adds a virtual coupling to the planned step of dt [s] of an element. The forces of spring and damper are those at
/// the end of the step (implicit Euler), so that any stiffness is stable. `pose`: the element's pose at the start.
void planHand(const Hand& hand, const RigidModel& model, double dt, const Pose& pose, RigidPlanElement& planned);

} // namespace filasofia::engine
