#include "filasofia/engine/elastic/membrane.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace filasofia::engine {
namespace {

/// The law at a state, divided by mu, with its derivatives by t and a.
struct SheetResponse {
    double energy = 0.0;
    double phi1 = 1.0, phi2 = 0.0; ///< phi', phi''
    double psi1 = 0.0, psi2 = 0.0; ///< derivatives of psi = (1 + q) (1 - a) / (q + a)
};

SheetResponse responseAt(double poissonRatio, double t, double a)
{
    const double q = std::max(1.0 - 2.0 * poissonRatio, kLeastQ), over = 1.0 / (q + a);
    SheetResponse at;
    double phi = t;
    if (t < kLeastTrace) {
        phi = 0.5 * (t * t / kLeastTrace + kLeastTrace);
        at.phi1 = t / kLeastTrace;
        at.phi2 = 1.0 / kLeastTrace;
    }
    at.psi1 = -(1.0 + q) * (1.0 + q) * over * over;
    at.psi2 = -2.0 * at.psi1 * over;
    at.energy = 0.5 * (phi - 2.0 + (1.0 + q) * (1.0 - a) * over);
    return at;
}

/// A triangle in its present state.
struct SheetShape {
    Vec3 e1, e2, normal;         ///< [m] edges 01 and 02; the unit normal, zero if the triangle is flat
    double detMetric = 0.0;      ///< det G [1/m^4]
    double trace = 0.0, a = 0.0; ///< tr C, det C
    double apart = 0.0;          ///< half of the difference of the squared principal stretches
};

SheetShape shapeOf(const MembraneElement& element, const TriangleCorners& x)
{
    const auto [g11, g12, g22] = element.metric;
    SheetShape shape{.e1 = x[1] - x[0], .e2 = x[2] - x[0], .normal = {}, .detMetric = g11 * g22 - g12 * g12};
    const Vec3 twice = cross(shape.e1, shape.e2);
    shape.normal = normalized(twice);
    shape.trace = g11 * dot(shape.e1, shape.e1) + 2.0 * g12 * dot(shape.e1, shape.e2) + g22 * dot(shape.e2, shape.e2);
    shape.a = shape.detMetric * lengthSquared(twice);
    // From F = [e1 e2] B with an upper B, G = B B^T. The root of t^2/4 - a would turn a rounding into its root: a sheet
    // at rest would resist tilting as if it were stretched by 3e-4 in float.
    const double b22 = std::sqrt(g22);
    const Vec3 f1 = std::sqrt(shape.detMetric) / b22 * shape.e1, f2 = g12 / b22 * shape.e1 + b22 * shape.e2;
    shape.apart = std::hypot(0.5 * (dot(f1, f1) - dot(f2, f2)), dot(f1, f2));
    return shape;
}

/// T = B S B^T / mu, with the second Piola-Kirchhoff stress S = mu (phi' I + psi' cof C) and F = [e1 e2] B: the stress
/// of the edges, from which the force -(T_a1 e1 + T_a2 e2) pulls at node a.
std::array<double, 3> edgeStress(const MembraneElement& element, const SheetShape& shape, const SheetResponse& at)
{
    const double d = at.psi1 * shape.detMetric;
    return {at.phi1 * element.metric[0] + d * dot(shape.e2, shape.e2),
            at.phi1 * element.metric[1] - d * dot(shape.e1, shape.e2),
            at.phi1 * element.metric[2] + d * dot(shape.e1, shape.e1)};
}

/// The part of the stress that is tension: T with the negative principal values of S / mu replaced by zero. Those are
/// phi' + psi' (t/2 -+ apart).
std::array<double, 3> tension(const MembraneElement& element, const SheetShape& shape, const SheetResponse& at)
{
    const double high = at.phi1 + at.psi1 * (0.5 * shape.trace - shape.apart);
    const double low = at.phi1 + at.psi1 * (0.5 * shape.trace + shape.apart);
    const double share = low >= 0.0 ? 1.0 : high > 0.0 ? high / (high - low) : 0.0;
    const double shift = -share * std::min(low, 0.0);
    std::array<double, 3> stress = edgeStress(element, shape, at);
    for (std::size_t k = 0; k < 3; ++k) stress[k] = share * stress[k] + shift * element.metric[k];
    return stress;
}

} // namespace

MembraneElement membraneOn(const std::array<int, 3>& nodes, const TriangleCorners& rest)
{
    const Vec3 e1 = rest[1] - rest[0], e2 = rest[2] - rest[0];
    const double e11 = dot(e1, e1), e12 = dot(e1, e2), e22 = dot(e2, e2);
    const double size = lengthSquared(cross(e1, e2));
    return {.nodes = nodes, .metric = {e22 / size, -e12 / size, e11 / size}, .area = 0.5 * std::sqrt(size)};
}

double membraneEnergy(const MembraneElement& element, const TriangleCorners& x)
{
    const SheetShape shape = shapeOf(element, x);
    return element.area * element.shear * responseAt(element.poissonRatio, shape.trace, shape.a).energy;
}

TriangleCorners membraneForces(const MembraneElement& element, const TriangleCorners& x)
{
    const SheetShape shape = shapeOf(element, x);
    const auto [t11, t12, t22] = edgeStress(element, shape, responseAt(element.poissonRatio, shape.trace, shape.a));
    const double weight = element.area * element.shear;
    const Vec3 first = -weight * (t11 * shape.e1 + t12 * shape.e2);
    const Vec3 second = -weight * (t12 * shape.e1 + t22 * shape.e2);
    return {-(first + second), first, second};
}

// With dF = dG + n h^T, n the normal, the second derivative of W / mu is (Smith, de Goes and Kim 2019, in two
// dimensions)
//
//     phi' |dG|^2 - 2 c det dG + k (dA)^2 + 2 phi'' (F : dF)^2 + h . S h / mu,   c = -A psi',  k = psi' + 2 a psi''
//
// -2 c det dG adds c to the modes of dG that change angles, the flip, and takes it from those that keep them, the twist
// and the growth. There phi' - c can be negative, as in a sheet under pressure; it is then left out, and so are a
// negative k and the pressure in S.
MembraneTangent membraneTangent(const MembraneElement& element, const TriangleCorners& x, double turning)
{
    const SheetShape shape = shapeOf(element, x);
    const SheetResponse at = responseAt(element.poissonRatio, shape.trace, shape.a);
    const double c = -std::sqrt(shape.a) * at.psi1, twist = turning * std::max(0.0, at.phi1 - c);
    const double root = std::sqrt(shape.detMetric);
    const double straight = 0.5 * (at.phi1 + c + twist), turned = 0.5 * (at.phi1 + c - twist) * root;
    const double growth = std::max(0.0, at.psi1 + 2.0 * shape.a * at.psi2);
    const auto& [g11, g12, g22] = element.metric;
    const auto [t11, t12, t22] = tension(element, shape, at);

    const Mat3 across = outer(shape.normal, shape.normal), along = Mat3::identity() - across;
    const std::array area{root * cross(shape.e2, shape.normal), root * cross(shape.normal, shape.e1)}; // dA by edge
    const std::array trace{g11 * shape.e1 + g12 * shape.e2, g12 * shape.e1 + g22 * shape.e2};          // half of dt
    const auto block = [&](std::size_t i, std::size_t j, double g, double t) {
        return straight * g * along + turning * t * across + growth * outer(area[i], area[j]) +
               2.0 * at.phi2 * outer(trace[i], trace[j]);
    };
    const double weight = element.area * element.shear;
    return {.aa = weight * block(0, 0, g11, t11),
            .ab = weight * (block(0, 1, g12, t12) + turned * crossMatrix(shape.normal)),
            .bb = weight * block(1, 1, g22, t22)};
}

Mat3 stiffnessBlock(const MembraneTangent& tangent, int i, int j)
{
    const Mat3 ba = transpose(tangent.ab);
    if (i == 0 && j == 0) return tangent.aa + tangent.ab + ba + tangent.bb;
    if (i == 0) return j == 1 ? -1.0 * (tangent.aa + ba) : -1.0 * (tangent.ab + tangent.bb);
    if (j == 0) return transpose(stiffnessBlock(tangent, 0, i));
    if (i == j) return i == 1 ? tangent.aa : tangent.bb;
    return i == 1 ? tangent.ab : ba;
}

TriangleCorners stiffnessTimes(const MembraneTangent& tangent, const TriangleCorners& p)
{
    const Vec3 a = p[1] - p[0], b = p[2] - p[0];
    const Vec3 first = tangent.aa * a + tangent.ab * b, second = transposeTimes(tangent.ab, a) + tangent.bb * b;
    return {-(first + second), first, second};
}

namespace {

/// [Pa] mu / J: J = A s, with the stretch A of the area and s = A (1 + q) / (q + A^2) of the thickness. Zero without an
/// area.
double stressScale(const MembraneElement& element, double a, double thickness)
{
    const double q = std::max(1.0 - 2.0 * element.poissonRatio, kLeastQ);
    return a > 0.0 ? element.shear / thickness * (q + a) / (a * (1.0 + q)) : 0.0;
}

} // namespace

// sigma = F S F^T / J has the principal values mu / J (phi' l^2 + psi' a), with the squared stretches l^2.
double membranePrincipalStress(const MembraneElement& element, const TriangleCorners& x, double thickness)
{
    const SheetShape shape = shapeOf(element, x);
    const SheetResponse at = responseAt(element.poissonRatio, shape.trace, shape.a);
    return stressScale(element, shape.a, thickness) * (at.phi1 * (0.5 * shape.trace + shape.apart) + at.psi1 * shape.a);
}

Mat3 membraneStress(const MembraneElement& element, const TriangleCorners& x, double thickness)
{
    const SheetShape shape = shapeOf(element, x);
    const auto [t11, t12, t22] = edgeStress(element, shape, responseAt(element.poissonRatio, shape.trace, shape.a));
    return stressScale(element, shape.a, thickness) *
           (t11 * outer(shape.e1, shape.e1) + t12 * (outer(shape.e1, shape.e2) + outer(shape.e2, shape.e1)) +
            t22 * outer(shape.e2, shape.e2));
}

std::array<double, 2> membraneStretches(const MembraneElement& element, const TriangleCorners& x)
{
    const SheetShape shape = shapeOf(element, x);
    const double half = 0.5 * shape.trace;
    return {std::sqrt(half + shape.apart), std::sqrt(std::max(0.0, half - shape.apart))};
}

} // namespace filasofia::engine
