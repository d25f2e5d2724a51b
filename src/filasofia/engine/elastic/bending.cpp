#include "filasofia/engine/elastic/bending.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

// The gradient of an angle grows without end as a triangle becomes flat. Below this share of its area at rest a
// triangle counts as this large.
constexpr double kFlat = 0.05;

using Symmetric = std::array<double, 6>; // 00 01 02 11 12 22

constexpr std::size_t entryAt(std::size_t i, std::size_t j)
{
    const std::size_t low = std::min(i, j), high = std::max(i, j);
    return low == 0 ? high : low + high + 1;
}

std::array<double, 3> symmetricTimes(const Symmetric& s, const std::array<double, 3>& a)
{
    return {s[0] * a[0] + s[1] * a[1] + s[2] * a[2], s[1] * a[0] + s[3] * a[1] + s[4] * a[2],
            s[2] * a[0] + s[4] * a[1] + s[5] * a[2]};
}

/// The moment at an edge without a neighbour is zero: its angle follows from the others (Schur's complement).
void releaseEdge(std::size_t edge, Symmetric& s)
{
    const double own = s[entryAt(edge, edge)];
    if (own > 0.0) {
        const Symmetric before = s;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = i; j < 3; ++j)
                s[entryAt(i, j)] -= before[entryAt(i, edge)] * before[entryAt(edge, j)] / own;
    }
    for (std::size_t i = 0; i < 3; ++i) s[entryAt(i, edge)] = 0.0;
}

/// One hinge: edge b c, corner a of the triangle itself, d of its neighbour.
struct Hinge {
    double theta = 0.0;
    std::array<Vec3, 4> gradients{}; ///< by a, b, c, d
};

Hinge hingeAt(Vec3 a, Vec3 b, Vec3 c, Vec3 d, double leastArea)
{
    const Vec3 edge = c - b, own = cross(edge, a - c), other = cross(d - c, edge);
    const double length = std::sqrt(lengthSquared(edge));
    const double ownSize = std::max(lengthSquared(own), leastArea);
    const double otherSize = std::max(lengthSquared(other), leastArea);
    Hinge hinge;
    if (!(length > 0.0)) return hinge;
    hinge.theta = std::atan2(dot(cross(own, other), edge) / length, dot(own, other));
    const Vec3 g = length / ownSize * own, h = length / otherSize * other; // 1 / height, along the normals
    const double u = dot(a - b, edge) / (length * length), w = dot(d - b, edge) / (length * length);
    hinge.gradients = {-g, (1.0 - u) * g + (1.0 - w) * h, u * g + w * h, -h};
    return hinge;
}

std::array<double, 3> bent(const BendingElement& element, const std::array<double, 3>& theta)
{
    return {theta[0] - element.restAngles[0], theta[1] - element.restAngles[1], theta[2] - element.restAngles[2]};
}

Symmetric stiffnessOf(const BendingElement& element)
{
    Symmetric s = element.shape;
    for (double& each : s) each *= element.rigidity;
    return s;
}

} // namespace

BendingElement bendingOn(const std::array<int, 6>& nodes, const Hinged& hinged, const BendingCorners& rest,
                         double poissonRatio)
{
    const double doubled = length(cross(rest[1] - rest[0], rest[2] - rest[0]));
    BendingElement element{.nodes = nodes, .leastArea = kFlat * kFlat * doubled * doubled};
    std::array<Vec3, 3> edges;
    for (std::size_t i = 0; i < 3; ++i) edges[i] = rest[(i + 2) % 3] - rest[(i + 1) % 3];
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j) {
            const double lengths = length(edges[i]) * length(edges[j]), cosine = dot(edges[i], edges[j]) / lengths;
            element.shape[entryAt(i, j)] =
                lengths / (2.0 * doubled) * ((1.0 - poissonRatio) * cosine * cosine + poissonRatio);
        }
    for (std::size_t i = 0; i < 3; ++i)
        if (!hinged[i]) releaseEdge(i, element.shape);
    element.restAngles = bendingAngles(element, rest).theta;
    for (std::size_t i = 0; i < 3; ++i)
        if (!hinged[i]) element.restAngles[i] = 0.0;
    return element;
}

BendingAngles bendingAngles(const BendingElement& element, const BendingCorners& x)
{
    BendingAngles angles;
    for (std::size_t i = 0; i < 3; ++i) {
        const Hinge hinge = hingeAt(x[i], x[(i + 1) % 3], x[(i + 2) % 3], x[3 + i], element.leastArea);
        angles.theta[i] = hinge.theta;
        angles.gradients[i] = hinge.gradients;
    }
    return angles;
}

double bendingEnergy(const BendingElement& element, const BendingCorners& x)
{
    const std::array<double, 3> angles = bent(element, bendingAngles(element, x).theta);
    const std::array<double, 3> moments = symmetricTimes(stiffnessOf(element), angles);
    return 0.5 * (angles[0] * moments[0] + angles[1] * moments[1] + angles[2] * moments[2]);
}

BendingCorners bendingForces(const BendingElement& element, const BendingCorners& x)
{
    const BendingAngles angles = bendingAngles(element, x);
    const std::array<double, 3> moments = symmetricTimes(stiffnessOf(element), bent(element, angles.theta));
    BendingCorners forces{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 4; ++k)
            forces[static_cast<std::size_t>(hingeNodes(static_cast<int>(i))[k])] -= moments[i] * angles.gradients[i][k];
    return forces;
}

BendingTangent bendingTangent(const BendingElement& element, const BendingCorners& x)
{
    const BendingAngles angles = bendingAngles(element, x);
    BendingTangent tangent{.stiffness = stiffnessOf(element)};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 4; ++k)
            tangent.gradients[i][static_cast<std::size_t>(hingeNodes(static_cast<int>(i))[k])] = angles.gradients[i][k];
    return tangent;
}

Mat3 stiffnessBlock(const BendingTangent& tangent, int i, int j)
{
    Mat3 block;
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b)
            block += tangent.stiffness[entryAt(a, b)] * outer(tangent.gradients[a][static_cast<std::size_t>(i)],
                                                              tangent.gradients[b][static_cast<std::size_t>(j)]);
    return block;
}

BendingCorners stiffnessTimes(const BendingTangent& tangent, const BendingCorners& p)
{
    std::array<double, 3> rates{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 6; ++k) rates[i] += dot(tangent.gradients[i][k], p[k]);
    const std::array<double, 3> moments = symmetricTimes(tangent.stiffness, rates);
    BendingCorners product{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 6; ++k) product[k] += moments[i] * tangent.gradients[i][k];
    return product;
}

} // namespace filasofia::engine
