#include "filasofia/engine/rigid/virtual_coupling.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {

void hold(const Hand& hand, RigidState& state)
{
    const VirtualCoupling& coupling = hand.target.coupling;
    const auto place = std::ranges::lower_bound(state.hands, hand.element, {}, &Hand::element);
    const bool there = place != state.hands.end() && place->element == hand.element;
    const bool holds = coupling.linearStiffness > 0.0 || coupling.linearDamping > 0.0 ||
                       coupling.angularStiffness > 0.0 || coupling.angularDamping > 0.0;
    if (there && holds)
        *place = hand;
    else if (there)
        state.hands.erase(place);
    else if (holds)
        state.hands.insert(place, hand);
}

// The force at the end of the step is F = s (k (x_target - x - h (v + dv)) + b (v_target - v - dv)), with stiffness k,
// damping b and step h. With dv0, the change without the coupling, m dv = m dv0 + h F gives
//     (m + s h (b + h k)) dv = m dv0 + h F(dv = 0).
// If the force would exceed its limit, spring and damper are both weaker by the factor s: they remain a spring and a
// damper, so the step stays stable.
void planHand(const Hand& hand, const RigidModel& model, double dt, const Pose& pose, RigidPlanElement& planned)
{
    if (dt == 0.0) return;
    const MotionState target = atPoint({hand.target.pose, hand.target.velocity, hand.target.angularVelocity},
                                       model.inertias[planned.element].centre);
    const VirtualCoupling& coupling = hand.target.coupling;

    const Vec3 apart = target.pose.position - planned.centre - dt * planned.velocity;
    const Vec3 force = coupling.linearStiffness * apart + coupling.linearDamping * (target.velocity - planned.velocity);
    const double linear = limitFactor(length(force), coupling.forceLimit);
    const double mass = (1.0 + dt * model.linearDamping) * planned.mass;
    planned.heldMass = linear * dt * (coupling.linearDamping + dt * coupling.linearStiffness);
    planned.change.linear = (mass * planned.change.linear + linear * dt * force) / (mass + planned.heldMass);

    const Vec3 turned =
        rotationVector(target.pose.orientation * conjugate(pose.orientation)) - dt * planned.angularVelocity;
    const Vec3 torque = coupling.angularStiffness * turned +
                        coupling.angularDamping * (target.angularVelocity - planned.angularVelocity);
    const double angular = limitFactor(length(torque), coupling.torqueLimit);
    const Mat3 inertia = (1.0 + dt * model.angularDamping) * planned.inertia;
    planned.heldInertia = angular * dt * (coupling.angularDamping + dt * coupling.angularStiffness);
    planned.change.angular = inverse(inertia + planned.heldInertia * Mat3::identity()) *
                             (inertia * planned.change.angular + angular * dt * torque);
}

} // namespace filasofia::engine
