#include "filasofia/engine/elastic/stretch_law.h"

#include "filasofia/engine/elastic/laws/all-inl.h"
#include "filasofia/engine/elastic/stretch_modes-inl.h"

namespace filasofia::engine {
namespace {

namespace lanes = HWY_NAMESPACE;
using Axes = lanes::Stretches<double>;
using Response = lanes::StretchResponse<double>;

Axes axesOf(const Deformation& at)
{
    const Mat3 s = transposeTimes(at.rotation, at.f);
    double sym[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) sym[i][j] = s[i][j];
    return lanes::stretchesOf(sym);
}

Mat3 matrixOf(const double (&m)[3][3])
{
    return {{{m[0][0], m[0][1], m[0][2]}, {m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]}}};
}

Response responseAt(const physics::ElasticLaw& law, Lame material, const double (&s)[3])
{
    const double ratio = material.lambda / material.mu;
    return lanes::responseOf(law, s, ratio);
}

} // namespace

double stretchEnergy(const physics::ElasticLaw& law, Lame material, const Deformation& at)
{
    return material.mu * responseAt(law, material, axesOf(at).s).energy;
}

Mat3 stretchStress(const physics::ElasticLaw& law, Lame material, const Deformation& at)
{
    const Axes axes = axesOf(at);
    const Response w = responseAt(law, material, axes.s);
    const Mat3 v = matrixOf(axes.v);
    return at.rotation * (v * Mat3::diagonal(material.mu * Vec3{w.d[0], w.d[1], w.d[2]}) * transpose(v));
}

double cubedInvariant(const Mat3& f)
{
    const double volume = lanes::boundedBelow(determinant(f), lanes::kSmallestVolume);
    const double sum = trace(transposeTimes(f, f));
    return sum * sum * sum / (volume * volume);
}

StretchTangent stretchTangent(const physics::ElasticLaw& law, Lame material, const Deformation& at, double turning)
{
    const Axes axes = axesOf(at);
    const auto modes = lanes::modesOf(responseAt(law, material, axes.s), axes.s, turning);
    const Mat3 v = matrixOf(axes.v);
    return {at.rotation * v, v, material.mu * matrixOf(modes.a),
            material.mu * Vec3{modes.ahead[0], modes.ahead[1], modes.ahead[2]},
            material.mu * Vec3{modes.across[0], modes.across[1], modes.across[2]}};
}

Mat3 stressChange(const StretchTangent& tangent, const Mat3& df)
{
    const Mat3 h = transposeTimes(tangent.u, df) * tangent.v;
    Mat3 p = Mat3::diagonal(tangent.a * Vec3{h[0].x, h[1].y, h[2].z});
    for (int k = 0; k < 3; ++k) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        p[i][j] = tangent.ahead[k] * h[i][j] + tangent.across[k] * h[j][i];
        p[j][i] = tangent.ahead[k] * h[j][i] + tangent.across[k] * h[i][j];
    }
    return tangent.u * p * transpose(tangent.v);
}

Mat3 stiffnessBlock(const StretchTangent& tangent, Vec3 gi, Vec3 gj)
{
    const Vec3 bi = transposeTimes(tangent.v, gi), bj = transposeTimes(tangent.v, gj);
    Mat3 block; // along u; h = a bj^T for a change a of the node
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int k = 3 - i - j;
            if (i == j) {
                block[i][i] += tangent.a[i][i] * bj[i] * bi[i];
                continue;
            }
            block[i][i] += tangent.ahead[k] * bj[j] * bi[j];
            block[i][j] += tangent.a[i][j] * bj[j] * bi[i] + tangent.across[k] * bj[i] * bi[j];
        }
    return tangent.u * block * transpose(tangent.u);
}

} // namespace filasofia::engine
