#include "filasofia/engine/elastic/neo_hookean.h"

#include "filasofia/engine/elastic/stretch_response-inl.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

/// The derivative of the cofactor along df.
Mat3 cofactorChange(const Mat3& f, const Mat3& df)
{
    return {{cross(df[1], f[2]) + cross(f[1], df[2]), cross(df[2], f[0]) + cross(f[2], df[0]),
             cross(df[0], f[1]) + cross(f[0], df[1])}};
}

/// The slope of i(I) in the header.
double shearFactor(const Mat3& f) { return std::min(1.0, contract(f, f)); }
double bulkAt(Lame material, double volume)
{
    return material.lambda + material.mu * HWY_NAMESPACE::reciprocalSquare(volume);
}
double twistAt(Lame material, double volume)
{
    return material.lambda * (volume - 1.0) - material.mu * HWY_NAMESPACE::tangentReciprocal(volume);
}

/// An upper bound of the largest stretch, exact if the two others are equal: the eigenvalues of a symmetric matrix lie
/// within mean +- sqrt(2/3) |deviator|.
double largestStretch(const Mat3& s)
{
    const double mean = trace(s) / 3.0;
    return std::abs(mean) + std::sqrt(2.0 / 3.0) * frobeniusNorm(s - mean * Mat3::identity());
}

} // namespace

double neoHookeanEnergy(Lame material, const Mat3& f)
{
    const double volume = determinant(f), square = contract(f, f);
    const double shape = square < 1.0 ? 0.5 * (square * square + 1.0) : square;
    return material.mu * (0.5 * (shape - 3.0) - HWY_NAMESPACE::tangentLogarithm(volume)) +
           0.5 * material.lambda * (volume - 1.0) * (volume - 1.0);
}

Mat3 neoHookeanStress(Lame material, const Mat3& f)
{
    return material.mu * shearFactor(f) * f + twistAt(material, determinant(f)) * cofactor(f);
}

NeoHookeanTangent neoHookeanTangent(Lame material, const Deformation& at, double turning)
{
    constexpr double kSmallest = 1e-6; // [-] stretch
    const double volume = determinant(at.f);
    NeoHookeanTangent tangent{at.f, cofactor(at.f), material.mu * shearFactor(at.f), bulkAt(material, volume),
                              twistAt(material, volume)};
    if (volume - 1.0 < kTense) tangent.twist = std::min(tangent.twist, -material.mu);
    const double s = std::max(largestStretch(transposeTimes(at.rotation, at.f)), kSmallest);
    // If the element is small in all directions at once, bulk does not lift the mode in which all three change alike.
    const double least = tangent.shear + tangent.bulk / 3.0 * contract(tangent.cofactor, tangent.cofactor);
    const double lowest = -std::min(tangent.shear, 0.5 * least) / s;
    const double covered = std::max(tangent.shear, kTwistCovered * s * tangent.twist);
    tangent.twist = lowest + turning * (std::max(tangent.twist, lowest) - lowest);
    tangent.shear += turning * (covered - tangent.shear);
    return tangent;
}

Mat3 stressChange(const NeoHookeanTangent& tangent, const Mat3& df)
{
    return tangent.shear * df + tangent.bulk * contract(tangent.cofactor, df) * tangent.cofactor +
           tangent.twist * cofactorChange(tangent.f, df);
}

Mat3 stiffnessBlock(const NeoHookeanTangent& tangent, Vec3 gi, Vec3 gj)
{
    // d2J [a g_j^T, b g_i^T] = (a x b) . F (g_j x g_i)
    return tangent.shear * dot(gi, gj) * Mat3::identity() +
           tangent.bulk * outer(tangent.cofactor * gi, tangent.cofactor * gj) +
           tangent.twist * crossMatrix(tangent.f * cross(gj, gi));
}

} // namespace filasofia::engine
