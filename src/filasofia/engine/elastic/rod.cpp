#include "filasofia/engine/elastic/rod.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

// [-] 1 + cos of an angle of 168 degrees, from which on the denominator of the curvature is constant: without a bound
// the curvature and its gradient grow without end towards a fold of 180 degrees.
constexpr double kFold = 0.02;

/// The curvature and its derivatives by both edges.
struct Curvature {
    Vec3 kb = {};
    Mat3 byFirst = {}, bySecond = {}; ///< [1/m]
    Vec3 e = {}, f = {};              ///< [m]
    double le = 0.0, lf = 0.0;        ///< [m]
};

Curvature curvatureAt(Vec3 e, Vec3 f)
{
    Curvature out{.e = e, .f = f, .le = length(e), .lf = length(f)};
    const double both = out.le * out.lf, along = dot(e, f);
    if (!(both > 0.0)) return out; // an edge without a length has no direction: no moment, and never a NaN
    const bool folded = both + along < kFold * both;
    const double size = folded ? kFold * both : both + along;
    out.kb = 2.0 / size * cross(e, f);
    const double scale = folded ? kFold : 1.0;
    const Vec3 sizeByFirst = scale * out.lf / out.le * e + (folded ? Vec3{} : f);
    const Vec3 sizeBySecond = scale * out.le / out.lf * f + (folded ? Vec3{} : e);
    out.byFirst = 1.0 / size * (-2.0 * crossMatrix(f) - outer(out.kb, sizeByFirst));
    out.bySecond = 1.0 / size * (2.0 * crossMatrix(e) - outer(out.kb, sizeBySecond));
    return out;
}

/// The material axes of both edges.
struct Axes {
    std::array<Vec3, 2> one, two;
};

Axes axesAt(const RodPlace& at, const Curvature& c)
{
    return {at.directors, {cross(c.e, at.directors[0]) / c.le, cross(c.f, at.directors[1]) / c.lf}};
}

/// The curvature at rest, in the world, as each edge carries it.
std::array<Vec3, 2> carried(const RodJoint& joint, const Axes& axes)
{
    std::array<Vec3, 2> k;
    for (std::size_t j = 0; j < 2; ++j) k[j] = joint.rest[j][0] * axes.one[j] + joint.rest[j][1] * axes.two[j];
    return k;
}

/// Writes what belongs to a change of the curvature along p, p . d(kb)/dx, or of the twist, to the nodes.
void setNodes(Vec3 first, Vec3 second, RodVector& out)
{
    for (std::size_t i = 0; i < 3; ++i) {
        const auto axis = static_cast<int>(i);
        out[i] = -first[axis];
        out[4 + i] = first[axis] - second[axis];
        out[8 + i] = second[axis];
    }
}

/// The gradient of the twist. As the nodes move, the second director turns against the carried first one by the angle
/// of holonomy (Bergou et al. 2008, equation 9).
RodVector twistGradient(const Curvature& c)
{
    RodVector out{};
    setNodes(0.5 / c.le * c.kb, 0.5 / c.lf * c.kb, out);
    out[3] = -1.0;
    out[7] = 1.0;
    return out;
}

bool isDegenerate(const Curvature& c) { return !(c.le > 0.0 && c.lf > 0.0); }

/// A director turns with its edge, towards the edge only, and kb lies across both edges: so the motion of the nodes
/// changes kb . k_j by that of kb alone. `turn`: twistGradient().
void setForces(const RodJoint& joint, double twist, const Curvature& c, const std::array<Vec3, 2>& k,
               const RodVector& turn, RodVector& out)
{
    const Vec3 moment = joint.bend * (c.kb - 0.5 * (k[0] + k[1]));
    setNodes(-transposeTimes(c.byFirst, moment), -transposeTimes(c.bySecond, moment), out);
    out[3] = 0.5 * joint.bend * dot(c.kb, cross(c.e, k[0])) / c.le;
    out[7] = 0.5 * joint.bend * dot(c.kb, cross(c.f, k[1])) / c.lf;
    for (std::size_t i = 0; i < out.size(); ++i) out[i] -= joint.twist * twist * turn[i];
}

void setTangent(const RodJoint& joint, const Curvature& c, const Axes& axes, const std::array<Vec3, 2>& k,
                const RodVector& turn, RodTangent& out)
{
    // The components of kb - k_j along the axes of edge j: those along the edge itself belong to rotations.
    for (std::size_t j = 0; j < 2; ++j)
        for (std::size_t a = 0; a < 2; ++a) {
            RodTerm& term = out[2 * j + a];
            const Vec3 axis = a == 0 ? axes.one[j] : axes.two[j];
            term.stiffness = 0.5 * joint.bend;
            setNodes(transposeTimes(c.byFirst, axis), transposeTimes(c.bySecond, axis), term.gradient);
            term.gradient[j == 0 ? 3 : 7] = a == 0 ? joint.rest[j][1] : -joint.rest[j][0];
        }
    // |kb| grows faster than the angle: what that adds in the plane of bending.
    if (const double size = length(c.kb); size > 1e-12) {
        const Vec3 binormal = 1.0 / size * c.kb;
        const double beyond = size - 0.5 * dot(binormal, k[0] + k[1]);
        out[4].stiffness = joint.bend * std::max(0.0, beyond) * 0.5 * size / (1.0 + 0.25 * size * size);
        setNodes(transposeTimes(c.byFirst, binormal), transposeTimes(c.bySecond, binormal), out[4].gradient);
    }
    out[5] = {joint.twist, turn};
}

} // namespace

Vec3 rodCurvature(Vec3 e, Vec3 f) { return curvatureAt(e, f).kb; }

double rodEnergy(const RodJoint& joint, const RodPlace& at)
{
    const Curvature c = curvatureAt(at.x[1] - at.x[0], at.x[2] - at.x[1]);
    double energy = 0.5 * joint.twist * at.twist * at.twist;
    if (isDegenerate(c)) return energy;
    for (const Vec3 k : carried(joint, axesAt(at, c))) energy += 0.25 * joint.bend * lengthSquared(c.kb - k);
    return energy;
}

RodResponse rodResponse(const RodJoint& joint, const RodPlace& at)
{
    RodResponse out;
    const Curvature c = curvatureAt(at.x[1] - at.x[0], at.x[2] - at.x[1]);
    if (isDegenerate(c)) return out;
    const Axes axes = axesAt(at, c);
    const std::array<Vec3, 2> k = carried(joint, axes);
    const RodVector turn = twistGradient(c);
    setForces(joint, at.twist, c, k, turn, out.forces);
    setTangent(joint, c, axes, k, turn, out.tangent);
    return out;
}

Vec3 transported(Vec3 director, Vec3 from, Vec3 to)
{
    // The rotation takes `from` to `to` and keeps their cross product.
    const Vec3 axis = cross(from, to);
    const double along = dot(from, to);
    Vec3 turned = -director; // a reversed edge has no smallest rotation
    if (along > -1.0 + 1e-12)
        turned = along * director + cross(axis, director) + dot(axis, director) / (1.0 + along) * axis;
    turned -= dot(turned, to) * to; // against rounding
    return normalized(turned, normalized(cross(to, Vec3{to.z, to.x, to.y}), {1.0, 0.0, 0.0}));
}

double rodTwist(const std::array<Vec3, 2>& directors, const std::array<Vec3, 2>& directions)
{
    const Vec3 first = transported(directors[0], directions[0], directions[1]);
    return std::atan2(dot(cross(first, directors[1]), directions[1]), dot(first, directors[1]));
}

RodCurvature curvatureInMaterial(const RodPlace& at)
{
    const Curvature c = curvatureAt(at.x[1] - at.x[0], at.x[2] - at.x[1]);
    RodCurvature out{};
    if (isDegenerate(c)) return out;
    const Axes axes = axesAt(at, c);
    for (std::size_t j = 0; j < 2; ++j) out[j] = {dot(c.kb, axes.one[j]), dot(c.kb, axes.two[j])};
    return out;
}

RodCurvature plasticCurvature(const RodYield& yield, const RodCurvature& rest, const RodCurvature& now,
                              RodCurvature plastic)
{
    for (std::size_t j = 0; j < 2; ++j) {
        std::array<double, 2> beyond{};
        for (std::size_t a = 0; a < 2; ++a)
            beyond[a] = now[j][a] - rest[j][a] - (1.0 + yield.hardening) * plastic[j][a];
        const double size = std::hypot(beyond[0], beyond[1]);
        if (!(size > yield.curvature)) continue;
        const double flows = (size - yield.curvature) / ((1.0 + yield.hardening) * size);
        for (std::size_t a = 0; a < 2; ++a) plastic[j][a] += flows * beyond[a];
    }
    return plastic;
}

} // namespace filasofia::engine
