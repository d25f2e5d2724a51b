#include "filasofia/engine/elastic/corotational.h"

#include <algorithm>

namespace filasofia::engine {

Lame lameAt(Lame material, const Mat3& f) { return determinant(f) < 0.0 ? Lame{material.mu, 0.0} : material; }

double corotationalEnergy(Lame material, const Deformation& at)
{
    const auto [mu, lambda] = lameAt(material, at.f);
    const Mat3 strain = at.f - at.rotation;
    const double volumetric = contract(at.rotation, at.f) - 3.0;
    return mu * contract(strain, strain) + 0.5 * lambda * volumetric * volumetric;
}

Mat3 corotationalStress(Lame material, const Deformation& at)
{
    const auto [mu, lambda] = lameAt(material, at.f);
    return 2.0 * mu * (at.f - at.rotation) + lambda * (contract(at.rotation, at.f) - 3.0) * at.rotation;
}

double geometricStiffness(Lame material, const Deformation& at)
{
    const auto [mu, lambda] = material;
    const Mat3 s = transposeTimes(at.rotation, at.f);
    const double size = trace(s), tension = lambda / mu * (size - 3.0);
    if (!(tension > 2.0 && size - 3.0 > kTense)) return 0.0;
    // a lower bound for each sum of two stretches, relative to the trace
    const double least = determinant(Mat3::identity() - 1.0 / size * s);
    return mu * (1.0 + (tension - 2.0) / (size * std::max(least, kFlattest)));
}

WarpedTangent corotationalTangent(Lame material, const Deformation& at, double turning)
{
    const Lame now = lameAt(material, at.f);
    return {now, at.rotation, turning > 0.0 ? turning * geometricStiffness(now, at) : 0.0};
}

Mat3 stressChange(const WarpedTangent& tangent, const Mat3& df)
{
    const auto [mu, lambda] = tangent.material;
    const Mat3 h = df * transpose(tangent.rotation); // with respect to the rotated rest shape
    const Mat3 stress =
        mu * (h + transpose(h)) + lambda * trace(h) * Mat3::identity() + tangent.turning * (h - transpose(h));
    return stress * tangent.rotation;
}

Mat3 stiffnessBlock(const WarpedTangent& tangent, Vec3 gi, Vec3 gj)
{
    const auto [mu, lambda] = tangent.material;
    const Vec3 bi = tangent.rotation * gi, bj = tangent.rotation * gj;
    Mat3 block = lambda * outer(bi, bj) + (mu - tangent.turning) * outer(bj, bi);
    const double shear = (mu + tangent.turning) * dot(bi, bj);
    for (int k = 0; k < 3; ++k) block[k][k] += shear;
    return block;
}

Mat3 exactCorotationalChange(Lame material, const Deformation& at, const Mat3& df)
{
    // dR = R [w]x with (tr(S) I - S) w = axial(R^T dF - dF^T R), S = R^T F (e.g. McAdams et al. 2011, supplement).
    const auto [mu, lambda] = lameAt(material, at.f);
    const Mat3 s = transposeTimes(at.rotation, at.f), b = transposeTimes(at.rotation, df);
    const Vec3 axial{b[2].y - b[1].z, b[0].z - b[2].x, b[1].x - b[0].y};
    const Vec3 w = inverse(trace(s) * Mat3::identity() - s) * axial;
    const Mat3 dr = at.rotation * crossMatrix(w);
    return 2.0 * mu * (df - dr) + lambda * (contract(at.rotation, df) * at.rotation + (trace(s) - 3.0) * dr);
}

} // namespace filasofia::engine
