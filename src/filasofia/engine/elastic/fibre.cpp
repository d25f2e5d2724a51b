#include "filasofia/engine/elastic/fibre.h"

#include "filasofia/engine/elastic/fibre_response-inl.h"

namespace filasofia::engine {
namespace {

namespace lanes = HWY_NAMESPACE;

lanes::FibreResponse<double> responseAt(const physics::FibreFamily& family, const Mat3& h, const Mat3& s, const Mat3& f)
{
    if (h == Mat3{}) return {};
    return lanes::fibreResponse(family.stiffness, family.exponent, family.activeStress, contract(s, f) - 1.0);
}

} // namespace

Mat3 structureTensor(double dispersion, Vec3 direction)
{
    if (direction == Vec3{}) return {};
    return dispersion * Mat3::identity() + (1.0 - 3.0 * dispersion) * outer(direction, direction);
}

double fibreEnergy(const physics::FibreFamily& family, Vec3 direction, const Mat3& f)
{
    const Mat3 h = structureTensor(family.dispersion, direction);
    return responseAt(family, h, f * h, f).energy;
}

Mat3 fibreStress(const physics::FibreFamily& family, Vec3 direction, const Mat3& f)
{
    const Mat3 h = structureTensor(family.dispersion, direction), s = f * h;
    return 2.0 * responseAt(family, h, s, f).slope * s;
}

FibreTangent fibreTangent(const physics::FibreFamily& family, Vec3 direction, const Mat3& f, double turning)
{
    const Mat3 h = structureTensor(family.dispersion, direction), s = f * h;
    const auto w = responseAt(family, h, s, f);
    return {h, s, 2.0 * turning * w.slope, 4.0 * w.curvature};
}

Mat3 stressChange(const FibreTangent& tangent, const Mat3& df)
{
    return tangent.turning * (df * tangent.structure) + tangent.stiffness * contract(tangent.s, df) * tangent.s;
}

Mat3 stiffnessBlock(const FibreTangent& tangent, Vec3 gi, Vec3 gj)
{
    return tangent.turning * dot(gi, tangent.structure * gj) * Mat3::identity() +
           tangent.stiffness * outer(tangent.s * gi, tangent.s * gj);
}

} // namespace filasofia::engine
