#include "filasofia/sofa/rigid_loads.h"

#include <sofa/core/MechanicalParams.h>
#include <sofa/core/objectmodel/BaseContext.h>

#include <limits>

namespace filasofia::sofaengine {
namespace {

MotionState motionOf(const RigidTypes::Coord& x, const RigidTypes::Deriv& v)
{
    return {
        {fromSofa(x.getCenter()), fromSofa(x.getOrientation())}, fromSofa(getVCenter(v)), fromSofa(getVOrientation(v))};
}

/// The force and the torque of a hand without their limits.
CouplingForce pull(const RigidLoads::Hand& hand, const MotionState& body)
{
    VirtualCoupling free = hand.coupling;
    free.forceLimit = free.torqueLimit = std::numeric_limits<double>::infinity();
    return couplingForce(free, hand.target, body);
}

} // namespace

// The force at the end of the step without the hand decides, as in the native engine.
void RigidLoads::limitHands(double dt)
{
    const auto& x = this->mstate->read(::sofa::core::vec_id::read_access::position)->getValue();
    const auto& v = this->mstate->read(::sofa::core::vec_id::read_access::velocity)->getValue();
    for (std::size_t i = 0; i < hands.size(); ++i) {
        if (!hands[i]) continue;
        MotionState body = motionOf(x[i], v[i]);
        body.pose.position += dt * body.velocity;
        const Vec3 turn = dt * hands[i]->coupling.angularStiffness * body.angularVelocity;
        const CouplingForce force = pull(*hands[i], body);
        hands[i]->linear = limitFactor(length(force.force), hands[i]->coupling.forceLimit);
        hands[i]->angular = limitFactor(length(force.torque - turn), hands[i]->coupling.torqueLimit);
    }
}

RigidLoads::HandInertia RigidLoads::handInertia(std::size_t element, double dt) const
{
    if (element >= hands.size() || !hands[element]) return {};
    const Hand& hand = *hands[element];
    return {hand.linear * dt * (hand.coupling.linearDamping + dt * hand.coupling.linearStiffness),
            hand.angular * dt * (hand.coupling.angularDamping + dt * hand.coupling.angularStiffness)};
}

void RigidLoads::addForce(const ::sofa::core::MechanicalParams* /*params*/, DataVecDeriv& f, const DataVecCoord& x,
                          const DataVecDeriv& v)
{
    auto& force = *f.beginEdit();
    const ::sofa::type::Vec3 weight = getContext()->getGravity() * weightless;
    for (std::size_t i = 0; i < wrenches.size(); ++i) {
        getVCenter(force[i]) += toSofa(wrenches[i].force) - weight;
        getVOrientation(force[i]) += toSofa(wrenches[i].torque);
        if (!hands[i]) continue;
        const CouplingForce held = pull(*hands[i], motionOf(x.getValue()[i], v.getValue()[i]));
        getVCenter(force[i]) += toSofa(hands[i]->linear * held.force);
        getVOrientation(force[i]) += toSofa(hands[i]->angular * held.torque);
    }
    f.endEdit();
}

void RigidLoads::addDForce(const ::sofa::core::MechanicalParams* params, DataVecDeriv& df, const DataVecDeriv& dx)
{
    const SReal k = params->kFactor(), b = params->bFactor();
    auto& change = *df.beginEdit();
    const auto& moved = dx.getValue();
    for (std::size_t i = 0; i < hands.size(); ++i) {
        if (!hands[i]) continue;
        const VirtualCoupling& c = hands[i]->coupling;
        getVCenter(change[i]) -=
            getVCenter(moved[i]) * (hands[i]->linear * (k * c.linearStiffness + b * c.linearDamping));
        getVOrientation(change[i]) -=
            getVOrientation(moved[i]) * (hands[i]->angular * (k * c.angularStiffness + b * c.angularDamping));
    }
    df.endEdit();
}

} // namespace filasofia::sofaengine
