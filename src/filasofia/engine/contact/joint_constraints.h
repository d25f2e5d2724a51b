#pragma once

#include "filasofia/engine/contact/coupling.h"

/// Limits and dry friction of free joints, as constraints of a joint against space. They are solved together with
/// contacts.
///
///     limit:     C = arm * gap / dt + u >= 0
///     friction:  C = u = 0,   |impulse| <= dt * torque / arm
///
///     u       [m/s] the joint's velocity times the arm; at a limit, positive inwards
///     gap     [rad] or [m] to the limit
///     arm     [m] or [-] (JointInfo::arm)
///     torque  [N m] or [N] dry friction
namespace filasofia::engine {

/// Adds the constraints after the contacts and the welds. `dt` [s].
void addJointConstraints(double dt, const Scene& scene, Coupling& coupling);

/// Stores the joints' loads and reactions in the step of dt [s], and the starts of their next solve.
void keepJoints(double dt, const Coupling& coupling, Scene& scene);

} // namespace filasofia::engine
