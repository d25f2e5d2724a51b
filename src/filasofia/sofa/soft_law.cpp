#include "filasofia/sofa/soft_law.h"

#include "filasofia/sofa/corotational.h"

#include <sofa/component/solidmechanics/fem/hyperelastic/TetrahedronHyperelasticityFEMForceField.h>
#include <sofa/component/solidmechanics/spring/SpringForceField.h>

namespace filasofia::sofaengine {
namespace {

using ::sofa::core::objectmodel::New;
namespace solids = ::sofa::component::solidmechanics;
using Springs = solids::spring::SpringForceField<Vec3Types>;
using Hyperelastic = solids::fem::hyperelastic::TetrahedronHyperelasticityFEMForceField<Vec3Types>;

::sofa::core::objectmodel::BaseObject::SPtr hyperelastic(const SoftPlan& plan, const char* law)
{
    const double young = plan.youngModulus.front(), poisson = plan.poissonRatio.front();
    const double mu = young / (2 * (1 + poisson));
    const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
    auto forces = New<Hyperelastic>();
    forces->setMaterialName(law);
    Hyperelastic::SetParameterArray parameters;
    parameters.push_back(mu);
    parameters.push_back(lambda);
    forces->setparameter(parameters);
    return forces;
}

::sofa::core::objectmodel::BaseObject::SPtr corotational(const SoftPlan& plan)
{
    auto forces = New<CorotationalForces>();
    forces->d_method.setValue("polar");
    forces->d_youngModulus.setValue({plan.youngModulus.begin(), plan.youngModulus.end()});
    forces->d_poissonRatio.setValue({plan.poissonRatio.begin(), plan.poissonRatio.end()});
    return forces;
}

/// SOFA's component for the edges of a mesh divides stiffness by length; ours are equal springs.
::sofa::core::objectmodel::BaseObject::SPtr springsOf(const SoftPlan& plan, const physics::MassSpringMaterial& material,
                                                      SoftStates& state)
{
    auto forces = New<Springs>(&state, &state, 0.0, 0.0);
    for (const auto& [a, b] : plan.edges)
        forces->addSpring(
            static_cast<::sofa::Index>(a), static_cast<::sofa::Index>(b), material.stiffness, material.damping,
            distance(plan.mesh.nodes[static_cast<std::size_t>(a)], plan.mesh.nodes[static_cast<std::size_t>(b)]));
    return forces;
}

::sofa::core::objectmodel::BaseObject::SPtr continuumOf(const SoftPlan& plan, const physics::ElasticLaw& law)
{
    if (std::holds_alternative<physics::NeoHookean>(law)) return hyperelastic(plan, "StableNeoHookean");
    if (std::holds_alternative<physics::StVenantKirchhoff>(law)) return hyperelastic(plan, "StVenantKirchhoff");
    return corotational(plan);
}

} // namespace

::sofa::core::objectmodel::BaseObject::SPtr lawOf(const SoftPlan& plan, SoftStates& state)
{
    if (const auto* springs = std::get_if<physics::MassSpringMaterial>(&plan.def.material))
        return springsOf(plan, *springs, state);
    return continuumOf(plan, std::get<physics::FemMaterial>(plan.def.material).law);
}

} // namespace filasofia::sofaengine
