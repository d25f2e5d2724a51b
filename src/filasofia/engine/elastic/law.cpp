#include "filasofia/engine/elastic/law.h"

namespace filasofia::engine {

double energyDensity(const physics::ElasticLaw& law, Lame material, const Deformation& at)
{
    if (std::holds_alternative<physics::Corotational>(law)) return corotationalEnergy(material, at);
    if (std::holds_alternative<physics::NeoHookean>(law)) return neoHookeanEnergy(material, at.f);
    return stretchEnergy(law, material, at);
}

Mat3 stressAt(const physics::ElasticLaw& law, Lame material, const Deformation& at)
{
    if (std::holds_alternative<physics::Corotational>(law)) return corotationalStress(material, at);
    if (std::holds_alternative<physics::NeoHookean>(law)) return neoHookeanStress(material, at.f);
    return stretchStress(law, material, at);
}

Mat3 cauchyStress(const Mat3& stress, const Mat3& f)
{
    const double det = determinant(f);
    if (!(det > 1e-9)) return {};
    const Mat3 sigma = (1.0 / det) * (stress * transpose(f));
    return 0.5 * (sigma + transpose(sigma)); // symmetric up to the rotation's rounding
}

Mat3 cauchyStress(const physics::ElasticLaw& law, Lame material, const Deformation& at)
{
    return cauchyStress(stressAt(law, material, at), at.f);
}

ElementTangent tangentAt(const physics::ElasticLaw& law, Lame material, const Deformation& at, double turning)
{
    if (std::holds_alternative<physics::Corotational>(law)) return corotationalTangent(material, at, turning);
    if (std::holds_alternative<physics::NeoHookean>(law)) return neoHookeanTangent(material, at, turning);
    return stretchTangent(law, material, at, turning);
}

Mat3 stressChange(const ElementTangent& tangent, const Mat3& df)
{
    return std::visit([&](const auto& each) { return stressChange(each, df); }, tangent);
}

Mat3 stiffnessBlock(const ElementTangent& tangent, Vec3 gi, Vec3 gj)
{
    return std::visit([&](const auto& each) { return stiffnessBlock(each, gi, gj); }, tangent);
}

Corners stiffnessTimes(const ElementTangent& tangent, const FemElement& element, const Corners& x)
{
    return internalForces(element, stressChange(tangent, gradient(element, x)));
}

} // namespace filasofia::engine
