#include "filasofia/sofa/element_mass.h"

#include "filasofia/math/world_inertia.h"

#include <sofa/core/behavior/MechanicalState.h>
#include <sofa/core/objectmodel/BaseContext.h>

namespace filasofia::sofaengine {
namespace {

constexpr int kRounds = 10; // round by round: each gains the factor of half the angle of a step
using ::sofa::core::vec_id::read_access::position;
using ::sofa::core::vec_id::read_access::velocity;

} // namespace

void ElementMass::begin(double dt)
{
    const auto& x = this->mstate->read(position)->getValue();
    const auto& v = this->mstate->read(velocity)->getValue();
    middle_.resize(x.size());
    moments_.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Quat start = fromSofa(x[i].getOrientation());
        const Vec3 before = fromSofa(getVOrientation(v[i]));
        const Mat3 own = worldInertia(inertia, start);
        const Vec3 momentum = own * before;
        Vec3 through = before;
        for (int k = 0; k < kRounds; ++k) {
            const Vec3 half = 0.5 * dt * through;
            middle_[i] = worldInertia(inertia, axisAngle(half, length(half)) * start);
            through = inverse(middle_[i]) * momentum;
        }
        moments_[i] = (momentum - middle_[i] * before) / dt;
    }
}

void ElementMass::finish()
{
    const auto& x = this->mstate->read(position)->getValue();
    ::sofa::helper::WriteAccessor v(*this->mstate->write(::sofa::core::vec_id::write_access::velocity));
    for (std::size_t i = 0; i < middle_.size(); ++i) {
        const Vec3 momentum = middle_[i] * fromSofa(getVOrientation(v[i]));
        getVOrientation(v[i]) = toSofa(inverse(worldInertia(inertia, fromSofa(x[i].getOrientation()))) * momentum);
    }
}

void ElementMass::addMDx(const ::sofa::core::MechanicalParams* /*params*/, DataVecDeriv& f, const DataVecDeriv& dx,
                         SReal factor)
{
    ::sofa::helper::WriteAccessor force(f);
    const auto& moved = dx.getValue();
    for (std::size_t i = 0; i < middle_.size(); ++i) {
        getVCenter(force[i]) += getVCenter(moved[i]) * (factor * mass);
        getVOrientation(force[i]) += toSofa(factor * (middle_[i] * fromSofa(getVOrientation(moved[i]))));
    }
}

void ElementMass::accFromF(const ::sofa::core::MechanicalParams* /*params*/, DataVecDeriv& a, const DataVecDeriv& f)
{
    ::sofa::helper::WriteAccessor acceleration(a);
    const auto& force = f.getValue();
    for (std::size_t i = 0; i < middle_.size(); ++i) {
        getVCenter(acceleration[i]) = getVCenter(force[i]) / mass;
        getVOrientation(acceleration[i]) = toSofa(inverse(middle_[i]) * fromSofa(getVOrientation(force[i])));
    }
}

void ElementMass::addForce(const ::sofa::core::MechanicalParams* /*params*/, DataVecDeriv& f, const DataVecCoord& /*x*/,
                           const DataVecDeriv& /*v*/)
{
    ::sofa::helper::WriteAccessor force(f);
    const ::sofa::type::Vec3 weight = getContext()->getGravity() * mass;
    for (std::size_t i = 0; i < moments_.size(); ++i) {
        getVCenter(force[i]) += weight;
        getVOrientation(force[i]) += toSofa(moments_[i]);
    }
}

} // namespace filasofia::sofaengine
