#include "filasofia/engine/body/rod.h"

#include "filasofia/core/error.h"
#include "filasofia/engine/body/check_size.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

constexpr double kPi = 3.14159265358979323846;

Vec3 directionOf(std::span<const Vec3> x, std::size_t edge)
{
    return normalized(x[edge + 1] - x[edge], {1.0, 0.0, 0.0});
}

/// A unit vector across another one.
Vec3 anyAcross(Vec3 direction)
{
    const Vec3 axis = std::abs(direction.z) < 0.9 ? Vec3{0.0, 0.0, 1.0} : Vec3{1.0, 0.0, 0.0};
    return normalized(cross(axis, direction));
}

/// The angle that differs from `angle` by whole turns and is nearest to `near`.
double unwound(double angle, double near) { return angle + 2.0 * kPi * std::round((near - angle) / (2.0 * kPi)); }

Vec3 turnedAbout(Vec3 direction, Vec3 director, double angle)
{
    return std::cos(angle) * director + std::sin(angle) * cross(direction, director);
}

/// Frames that do not turn about the line, from end to end: it is not twisted.
std::vector<Vec3> parallelDirectors(std::span<const Vec3> x)
{
    std::vector<Vec3> directors{anyAcross(directionOf(x, 0))};
    for (std::size_t e = 1; e + 1 < x.size(); ++e)
        directors.push_back(transported(directors.back(), directionOf(x, e - 1), directionOf(x, e)));
    return directors;
}

} // namespace

Rod makeRod(const physics::RodBodyDef& def, const std::vector<Vec3>& nodes)
{
    const double r = def.radius, area = kPi * r * r, second = 0.25 * area * r * r; // second moment of area
    const double shear = def.youngModulus / (2.0 * (1.0 + def.poissonRatio));
    Rod rod{.radius = r, .needle = def.needle, .bend = def.youngModulus * second, .twist = shear * 2.0 * second};
    double whole = 0.0;
    for (std::size_t e = 0; e + 1 < nodes.size(); ++e) {
        const double l = distance(nodes[e], nodes[e + 1]);
        rod.edges.push_back({.nodes = {static_cast<int>(e), static_cast<int>(e) + 1},
                             .restLength = l,
                             .stiffness = def.youngModulus * area / l});
        rod.inertias.push_back(def.density * 2.0 * second * l);
        whole += l;
    }
    // The twist is even between the middles of the first edge and the last.
    const double between = whole - 0.5 * (rod.edges.front().restLength + rod.edges.back().restLength);
    rod.directors = parallelDirectors(nodes);
    rod.joints.resize(nodes.size() - 2);
    for (std::size_t j = 0; !def.straight && j < rod.joints.size(); ++j)
        rod.joints[j].rest = curvatureInMaterial(
            {.x = {nodes[j], nodes[j + 1], nodes[j + 2]}, .directors = {rod.directors[j], rod.directors[j + 1]}});
    double turned = 0.0;
    for (std::size_t j = 0; j < rod.joints.size(); ++j) {
        const double share = 0.5 * (rod.edges[j].restLength + rod.edges[j + 1].restLength) / between;
        rod.startTwists.push_back(share * def.twist);
        turned += share * def.twist;
        rod.directors[j + 1] = turnedAbout(directionOf(nodes, j + 1), rod.directors[j + 1], turned);
    }
    return rod;
}

RodState stateAtStart(const Rod& rod)
{
    return {rod.directors, std::vector<double>(rod.edges.size()), rod.startTwists,
            std::vector<double>(rod.edges.size())};
}

std::vector<RodJoint> stiffJoints(const Rod& rod, const std::vector<bool>& hard)
{
    std::vector<RodJoint> joints = rod.joints;
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const bool first = clamped(hard, j), second = clamped(hard, j + 1), both = first == second;
        const double length = 0.5 * ((both || second ? rod.edges[j].restLength : 0.0) +
                                     (both || first ? rod.edges[j + 1].restLength : 0.0));
        joints[j].bend = rod.bend / length;
        joints[j].twist = rod.twist / length;
    }
    return joints;
}

RodPlace placeAt(const RodState& state, std::span<const Vec3> x, std::size_t joint)
{
    return {.x = {x[joint], x[joint + 1], x[joint + 2]},
            .directors = {state.directors[joint], state.directors[joint + 1]},
            .twist = state.twists[joint]};
}

void moveRod(double dt, std::span<const Vec3> from, std::span<const Vec3> to, const RodState& state, RodState& out)
{
    const std::size_t edges = state.directors.size();
    out.directors.resize(edges);
    out.twists.resize(state.twists.size());
    for (std::size_t e = 0; e < edges; ++e) {
        const Vec3 now = directionOf(to, e);
        const Vec3 carried = transported(state.directors[e], directionOf(from, e), now);
        out.directors[e] = turnedAbout(now, carried, dt * out.spins[e]);
    }
    for (std::size_t j = 0; j + 1 < edges; ++j)
        out.twists[j] =
            unwound(rodTwist({out.directors[j], out.directors[j + 1]}, {directionOf(to, j), directionOf(to, j + 1)}),
                    state.twists[j]);
}

void straighten(std::span<const Vec3> x, std::vector<Vec3>& directors)
{
    for (std::size_t e = 0; e < directors.size(); ++e) {
        const Vec3 direction = directionOf(x, e);
        const double along = dot(directors[e], direction);
        if (std::abs(along) > 1e-9) directors[e] = normalized(directors[e] - along * direction, anyAcross(direction));
    }
}

void check(const Rod& rod, const RodState& state, std::size_t nodes, const std::string& object)
{
    if (rod.edges.empty()) return;
    checkSize(object, "rod.edges", rod.edges.size(), nodes - 1);
    checkSize(object, "rod.inertias", rod.inertias.size(), nodes - 1);
    checkSize(object, "rod.joints", rod.joints.size(), nodes - 2);
    checkSize(object, "rod.directors", state.directors.size(), nodes - 1);
    checkSize(object, "rod.spins", state.spins.size(), nodes - 1);
    checkSize(object, "rod.twists", state.twists.size(), nodes - 2);
    checkSize(object, "rod.tensions", state.tensions.size(), nodes - 1);
    const auto positive = [&](const char* field, double value) {
        if (!(value > 0.0) || !std::isfinite(value)) fail(object, ": ", field, " must be > 0, got ", value);
    };
    positive("rod.radius", rod.radius);
    positive("rod.bend", rod.bend);
    positive("rod.twist", rod.twist);
    for (const Spring& edge : rod.edges) {
        positive("rod.edges.restLength", edge.restLength);
        positive("rod.edges.stiffness", edge.stiffness);
    }
    for (double each : rod.inertias) positive("rod.inertias", each);
    for (Vec3 each : state.directors)
        if (!(std::abs(lengthSquared(each) - 1.0) < 1e-6)) fail(object, ": rod.directors must be unit vectors");
    for (const auto* list : {&state.spins, &state.twists, &state.tensions})
        for (double each : *list)
            if (!std::isfinite(each)) fail(object, ": rod.spins, rod.twists and rod.tensions must be finite");
}

} // namespace filasofia::engine
