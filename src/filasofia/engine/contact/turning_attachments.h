#pragma once

#include "filasofia/engine/contact/coupling.h"

namespace filasofia::engine {

/// Sets where the constraint of a point of a rigid body acts, and the point's velocity, so that it follows the chord of
/// the arc on which the body carries it in a step of dt [s]. The body turns as it is planned to. If `share` [-] is less
/// than 1, the place that was foreseen before moves there by that share only.
void foreseeArc(double dt, const RigidPlanElement& planned, BodyPoint& point, double share = 1.0);

/// Welds foresee where a rigid body's points come to be by how it turns without constraints. If the solve has made it
/// turn otherwise, they foresee it anew, by a `share` [-] of the difference, and the step is to be solved again: true.
bool foreseeTurns(double dt, double share, Coupling& coupling);

/// The soft bodies that welds hold at points of rigid bodies which come to be more than 0.1 mm from where they were
/// foreseen: as far off the step ends with what they hold. A body may be named several times.
std::vector<std::size_t> heldElsewhere(double dt, const Coupling& coupling);

/// A thread, or tissue, that pulls at one point of a rigid body turns it as a weight does a pendulum. Within a step the
/// pull counts as inertia, or a light body would turn ever farther to and fro: needles of 5 mg did, by 0.6 rad a step
/// at 50 mN. (Several points hold how a body is turned, and what two rigid bodies pull at each other may be strain of
/// a grip alone.)
void addHeldInertia(double dt, const Constraint& weld, RigidPlan& plan);

} // namespace filasofia::engine
