#pragma once

#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/rigid/rigid_step.h"

#include <array>

namespace filasofia::engine {

/// What turns carries its points along an arc, and a contact that they come down to is solved where they will be then.
/// A ball that rolls at 100 rad/s was borne at 1 kHz by what came down a tenth of a radian ahead of its centre, and
/// lost half its speed in a second; now 7 %. Both sides are shifted alike, as momentum asks for it: by the one that
/// turns more.
/// Along the surface, what sticks must go along the arc, too: by the velocity at the start alone, it would leave it
/// along the tangent. A block between plates that turned about an axis beside them crept outwards by r w^2 h / 2,
/// however hard they pressed. `arms`: of each side, from the part of its core that is in contact to the surface of a
/// ball or capsule around it, which turning does not move [m].
void turnContact(double dt, const RigidPlan& plan, const std::array<Vec3, 2>& arms, Constraint& contact);

} // namespace filasofia::engine
