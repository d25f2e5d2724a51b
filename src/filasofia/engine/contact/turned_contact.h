#pragma once

#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/rigid/rigid_step.h"

namespace filasofia::engine {

/// What turns carries its points along an arc, and a contact that they come down to is solved where they will be then.
/// A ball that rolls at 100 rad/s was borne at 1 kHz by what came down a tenth of a radian ahead of its centre, and
/// lost half its speed in a second; now 7 %. Both sides are shifted alike, as momentum asks for it: by the one that
/// turns more.
void turnContact(double dt, const RigidPlan& plan, Constraint& contact);

} // namespace filasofia::engine
