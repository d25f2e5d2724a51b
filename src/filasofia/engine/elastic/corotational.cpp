#include "filasofia/engine/elastic/corotational.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

/// -V P g_i: the forces at the nodes from a first Piola-Kirchhoff stress P.
Corners forcesOf(const FemElement& element, const Mat3& stress)
{
    Corners forces;
    for (int i = 0; i < 4; ++i) forces[i] = -element.volume * (stress * element.gradients[i]);
    return forces;
}

} // namespace

Lame lameAt(const FemElement& element, const Mat3& f)
{
    const Lame all = lame(element.youngModulus, element.poissonRatio);
    return determinant(f) < 0.0 ? Lame{all.mu, 0.0} : all;
}

Corners shapeGradients(const Corners& rest)
{
    // The rows of the inverse of the edge matrix are the gradients of nodes 1, 2, 3; the four sum to zero.
    const Mat3 edges = Mat3::columns(rest[1] - rest[0], rest[2] - rest[0], rest[3] - rest[0]);
    const Mat3 rows = inverse(edges);
    return {-(rows[0] + rows[1] + rows[2]), rows[0], rows[1], rows[2]};
}

Mat3 gradient(const FemElement& element, const Corners& x)
{
    // Relative to node 0, so that a translation of any size changes nothing.
    Mat3 sum;
    for (int i = 1; i < 4; ++i) sum += outer(x[i] - x[0], element.gradients[i]);
    return sum;
}

double corotationalEnergy(const FemElement& element, const Mat3& f, const Mat3& rotation)
{
    const auto [mu, lambda] = lameAt(element, f);
    const Mat3 strain = f - rotation;
    const double volumetric = contract(rotation, f) - 3.0;
    return element.volume * (mu * contract(strain, strain) + 0.5 * lambda * volumetric * volumetric);
}

Corners corotationalForces(const FemElement& element, const Mat3& f, const Mat3& rotation)
{
    const auto [mu, lambda] = lameAt(element, f);
    return forcesOf(element, 2.0 * mu * (f - rotation) + lambda * (contract(rotation, f) - 3.0) * rotation);
}

double geometricStiffness(Lame material, const Mat3& f, const Mat3& rotation)
{
    const auto [mu, lambda] = material;
    const Mat3 s = transposeTimes(rotation, f);
    const double size = trace(s), tension = lambda / mu * (size - 3.0);
    if (!(tension > 2.0 && size - 3.0 > kTense)) return 0.0;
    // a lower bound for each sum of two stretches, relative to the trace
    const double least = determinant(Mat3::identity() - 1.0 / size * s);
    return mu * (1.0 + (tension - 2.0) / (size * std::max(least, kFlattest)));
}

Corners warpedStiffnessTimes(const FemElement& element, const Tangent& tangent, const Mat3& rotation, const Corners& x)
{
    const auto [mu, lambda] = tangent.material;
    const Mat3 h = gradient(element, x) * transpose(rotation); // with respect to the rotated rest shape
    const Mat3 stress =
        mu * (h + transpose(h)) + lambda * trace(h) * Mat3::identity() + tangent.turning * (h - transpose(h));
    Corners product = forcesOf(element, stress * rotation);
    for (Vec3& each : product) each = -each;
    return product;
}

Mat3 warpedStiffnessBlock(const Corners& b, const Tangent& tangent, double volume, int i, int j)
{
    const auto [mu, lambda] = tangent.material;
    Mat3 block = lambda * outer(b[i], b[j]) + (mu - tangent.turning) * outer(b[j], b[i]);
    const double shear = (mu + tangent.turning) * dot(b[i], b[j]);
    for (int k = 0; k < 3; ++k) block[k][k] += shear;
    return volume * block;
}

Corners exactForceChange(const FemElement& element, const Mat3& f, const Mat3& rotation, const Corners& dx)
{
    // dR = R [w]x with (tr(S) I - S) w = axial(R^T dF - dF^T R), S = R^T F (e.g. McAdams et al. 2011, supplement).
    const auto [mu, lambda] = lameAt(element, f);
    const Mat3 df = gradient(element, dx);
    const Mat3 s = transposeTimes(rotation, f), b = transposeTimes(rotation, df);
    const Vec3 axial{b[2].y - b[1].z, b[0].z - b[2].x, b[1].x - b[0].y};
    const Vec3 w = inverse(trace(s) * Mat3::identity() - s) * axial;
    const Mat3 dr = rotation * crossMatrix(w);
    return forcesOf(element,
                    2.0 * mu * (df - dr) + lambda * (contract(rotation, df) * rotation + (trace(s) - 3.0) * dr));
}

} // namespace filasofia::engine
