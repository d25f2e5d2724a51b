#include "filasofia/sofa/body_loads.h"

#include <sofa/core/MechanicalParams.h>
#include <sofa/core/behavior/BaseLocalForceFieldMatrix.h>
#include <sofa/core/objectmodel/BaseContext.h>

namespace filasofia::sofaengine {
namespace {

using SofaVec = ::sofa::type::Vec3;

/// The pressure of a closed surface pushes inwards, and follows it.
template <class Positions, class Forces>
void addPressure(const std::vector<std::array<int, 3>>& surface, double pressure, const Positions& x, Forces& f)
{
    for (const auto& [a, b, c] : surface) {
        const SofaVec area = cross(x[b] - x[a], x[c] - x[a]) * 0.5;
        const SofaVec third = area * (-pressure / 3.0);
        f[a] += third;
        f[b] += third;
        f[c] += third;
    }
}

} // namespace

void BodyLoads::addForce(const ::sofa::core::MechanicalParams* /*params*/, DataVecDeriv& f, const DataVecCoord& x,
                         const DataVecDeriv& /*v*/)
{
    auto& force = *f.beginEdit();
    const auto& at = x.getValue();
    for (const physics::NodalForce& each : forces) force[static_cast<std::size_t>(each.node)] += toSofa(each.force);
    for (const Spring& spring : springs) force[spring.node] += (spring.place - at[spring.node]) * spring.stiffness;
    if (pressure != 0.0) addPressure(surface, pressure, at, force);
    const SofaVec gravity = getContext()->getGravity();
    for (std::size_t i = 0; i < weightless.size(); ++i) force[i] -= gravity * weightless[i];
    f.endEdit();
}

void BodyLoads::addDForce(const ::sofa::core::MechanicalParams* params, DataVecDeriv& df, const DataVecDeriv& dx)
{
    const SReal factor = ::sofa::core::mechanicalparams::kFactorIncludingRayleighDamping(params, 0.0);
    auto& change = *df.beginEdit();
    const auto& moved = dx.getValue();
    for (const Spring& spring : springs) change[spring.node] -= moved[spring.node] * (spring.stiffness * factor);
    df.endEdit();
}

void BodyLoads::buildStiffnessMatrix(::sofa::core::behavior::StiffnessMatrix* matrix)
{
    auto dfdx = matrix->getForceDerivativeIn(mstate).withRespectToPositionsIn(mstate);
    for (const Spring& spring : springs)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto at = static_cast<::sofa::SignedIndex>(3 * spring.node + axis);
            dfdx(at, at) += -spring.stiffness;
        }
}

} // namespace filasofia::sofaengine
