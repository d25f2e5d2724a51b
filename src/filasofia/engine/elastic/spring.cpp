#include "filasofia/engine/elastic/spring.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

constexpr double kTiny = 1e-12; // [m] shorter springs have no direction

/// The unit vector from a to b. Zero if the ends coincide: the force is then zero, never a NaN.
Vec3 direction(Vec3 a, Vec3 b)
{
    const double l = distance(a, b);
    return l < kTiny ? Vec3{} : (b - a) / l;
}

} // namespace

Vec3 springForce(const Spring& spring, Vec3 a, Vec3 b)
{
    return spring.stiffness * (distance(a, b) - spring.restLength) * direction(a, b);
}

Vec3 dashpotForce(const Spring& spring, Vec3 a, Vec3 b, Vec3 velocityA, Vec3 velocityB)
{
    const Vec3 n = direction(a, b);
    return spring.damping * dot(velocityB - velocityA, n) * n;
}

Mat3 springStiffness(const Spring& spring, Vec3 a, Vec3 b)
{
    const double l = distance(a, b);
    const Mat3 along = outer(direction(a, b), direction(a, b));
    const double across = l < kTiny ? 0.0 : std::max(0.0, 1.0 - spring.restLength / l);
    return spring.stiffness * (along + across * (Mat3::identity() - along));
}

Mat3 springDamping(const Spring& spring, Vec3 a, Vec3 b)
{
    return spring.damping * outer(direction(a, b), direction(a, b));
}

double springEnergy(const Spring& spring, Vec3 a, Vec3 b)
{
    const double stretch = distance(a, b) - spring.restLength;
    return 0.5 * spring.stiffness * stretch * stretch;
}

Spring springOn(const std::array<int, 2>& edge, const Spring& like, const std::vector<Vec3>& rest)
{
    Spring spring = like;
    spring.nodes = edge;
    spring.restLength = distance(rest[static_cast<std::size_t>(edge[0])], rest[static_cast<std::size_t>(edge[1])]);
    return spring;
}

} // namespace filasofia::engine
