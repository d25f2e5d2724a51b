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
    return normalized(x[wrapped(edge + 1, x.size())] - x[edge], {1.0, 0.0, 0.0});
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
std::vector<Vec3> parallelDirectors(std::span<const Vec3> x, std::size_t edges)
{
    std::vector<Vec3> directors{anyAcross(directionOf(x, 0))};
    for (std::size_t e = 1; e < edges; ++e)
        directors.push_back(transported(directors.back(), directionOf(x, e - 1), directionOf(x, e)));
    return directors;
}

/// [rad] in [-pi, pi]: the twist of a joint, as the directors show it.
double twistAt(std::span<const Vec3> x, const std::vector<Vec3>& directors, std::size_t joint)
{
    const std::size_t next = wrapped(joint + 1, directors.size());
    return rodTwist({directors[joint], directors[next]}, {directionOf(x, joint), directionOf(x, next)});
}

} // namespace

Rod makeRod(const physics::RodBodyDef& def, const std::vector<Vec3>& nodes)
{
    const double r = def.radius, area = kPi * r * r, second = 0.25 * area * r * r; // second moment of area
    const double shear = def.youngModulus / (2.0 * (1.0 + def.poissonRatio));
    Rod rod{.radius = r, .needle = def.needle, .bend = def.youngModulus * second, .twist = shear * 2.0 * second};
    rod.breakForce = def.breakForce;
    rod.yieldCurvature = def.yieldStrain / r;
    rod.hardening = def.hardening / (1.0 - def.hardening); // the moment grows by B H / (B + H) beyond yield
    double whole = 0.0;
    const std::size_t edges = def.closed ? nodes.size() : nodes.size() - 1, joints = def.closed ? edges : edges - 1;
    for (std::size_t e = 0; e < edges; ++e) {
        const std::size_t next = wrapped(e + 1, nodes.size());
        const double l = distance(nodes[e], nodes[next]);
        rod.edges.push_back({.nodes = {static_cast<int>(e), static_cast<int>(next)},
                             .restLength = l,
                             .stiffness = def.youngModulus * area / l});
        rod.inertias.push_back(def.density * 2.0 * second * l);
        whole += l;
    }
    // The twist is even between the middles of the first edge and the last.
    const double between =
        whole - (def.closed ? 0.0 : 0.5 * (rod.edges.front().restLength + rod.edges.back().restLength));
    rod.directors = parallelDirectors(nodes, edges);
    rod.joints.resize(joints);
    rod.startTwists.resize(joints);
    const RodState untwisted{.directors = rod.directors,
                             .spins = {},
                             .twists = rod.startTwists,
                             .tensions = {},
                             .steering = {},
                             .plastic = {}};
    for (std::size_t j = 0; !def.straight && j < joints; ++j)
        rod.joints[j].rest = curvatureInMaterial(placeAt(untwisted, nodes, j));
    double turned = 0.0;
    for (std::size_t j = 0; j < joints; ++j) {
        const std::size_t next = wrapped(j + 1, edges);
        const double share = 0.5 * (rod.edges[j].restLength + rod.edges[next].restLength) / between;
        rod.startTwists[j] = share * def.twist;
        turned += rod.startTwists[j];
        if (next > 0) rod.directors[next] = turnedAbout(directionOf(nodes, next), rod.directors[next], turned);
    }
    if (def.closed) rod.seam = rod.startTwists.back() - twistAt(nodes, rod.directors, joints - 1);
    return rod;
}

RodState stateAtStart(const Rod& rod)
{
    return {rod.directors,
            std::vector<double>(rod.edges.size()),
            rod.startTwists,
            std::vector<double>(rod.edges.size()),
            {},
            std::numeric_limits<double>::infinity(),
            std::vector<RodCurvature>(canYield(rod) ? rod.joints.size() : 0)};
}

namespace {

/// Whether an edge beside a joint is cut: then it bears nothing.
bool isBroken(const Rod& rod, std::size_t joint)
{
    return isCut(rod, joint) || isCut(rod, wrapped(joint + 1, rod.edges.size()));
}

/// [m] The length of rod that bends at a joint.
double bentLength(const Rod& rod, const std::vector<bool>& hard, std::size_t joint)
{
    const auto isStiff = [&](std::size_t e) { return clamped(hard, e) || (!rod.held.empty() && rod.held[e]); };
    const std::size_t next = wrapped(joint + 1, rod.edges.size());
    const bool first = isStiff(joint), second = isStiff(next), both = first == second;
    return 0.5 *
           ((both || second ? rod.edges[joint].restLength : 0.0) + (both || first ? rod.edges[next].restLength : 0.0));
}

} // namespace

RodJoint stiffJoint(const Rod& rod, const std::vector<bool>& hard, std::size_t index)
{
    RodJoint joint = rod.joints[index];
    const double length = bentLength(rod, hard, index);
    joint.bend = isBroken(rod, index) ? 0.0 : rod.bend / length;
    joint.twist = isBroken(rod, index) ? 0.0 : rod.twist / length;
    return joint;
}

std::vector<RodJoint> stiffJoints(const Rod& rod, const std::vector<bool>& hard)
{
    std::vector<RodJoint> joints;
    for (std::size_t j = 0; j < rod.joints.size(); ++j) joints.push_back(stiffJoint(rod, hard, j));
    return joints;
}

namespace {

/// The curvature at rest without what has flowed, for a joint that stands for `length` [m] of rod.
RodCurvature restOf(const RodCurvature& rest, double length, const RodState& state, std::size_t index)
{
    if (state.steering.empty()) return rest;
    constexpr double kMostHalf = 0.5 * physics::kMostTurnPerNode; // [rad]
    const auto& [along, across] = state.steering[index].now;
    const double size = std::hypot(along, across);
    if (size == 0.0) return rest;
    // The rod turns by an angle of size * length; kb lies across the way that it bends to.
    const double scale = 2.0 * std::tan(std::min(0.5 * size * length, kMostHalf)) / size;
    RodCurvature out = rest;
    for (auto& edge : out) {
        edge[0] -= scale * across;
        edge[1] += scale * along;
    }
    return out;
}

} // namespace

RodJoint jointNow(const Rod& rod, const RodJoint& joint, const RodState& state, std::size_t index)
{
    RodJoint now = joint;
    if (joint.bend == 0.0) return now; // broken
    now.rest = restOf(joint.rest, rod.bend / joint.bend, state, index);
    for (std::size_t j = 0; j < 2 && !state.plastic.empty(); ++j)
        for (std::size_t a = 0; a < 2; ++a) now.rest[j][a] += state.plastic[index][j][a];
    return now;
}

void flow(const Rod& rod, const std::vector<bool>& hard, std::span<const Vec3> x, RodState& state)
{
    for (std::size_t j = 0; j < state.plastic.size(); ++j) {
        if (isBroken(rod, j)) continue;
        const double length = bentLength(rod, hard, j);
        state.plastic[j] =
            plasticCurvature({rod.yieldCurvature * length, rod.hardening}, restOf(rod.joints[j].rest, length, state, j),
                             curvatureInMaterial(placeAt(state, x, j)), state.plastic[j]);
    }
}

void listCutEdges(const Rod& rod, std::vector<int>& out)
{
    out.clear();
    for (std::size_t e = 0; e < rod.cut.size(); ++e)
        if (rod.cut[e]) out.push_back(static_cast<int>(e));
}

void setCurvature(const physics::SetCurvature& command, const Rod& rod, RodState& state)
{
    state.steering.resize(rod.joints.size());
    state.steeringRate = command.rate;
    double whole = 0.0, at = 0.0;
    for (const Spring& edge : rod.edges) whole += edge.restLength;
    for (std::size_t j = 0; j < rod.joints.size(); ++j) {
        const std::size_t next = wrapped(j + 1, rod.edges.size());
        const double before = 0.5 * rod.edges[j].restLength, after = 0.5 * rod.edges[next].restLength;
        at += rod.edges[j].restLength;
        const auto inside = [&](const physics::RodSection& section, double middle) {
            return std::max(0.0,
                            std::min({section.end, whole, middle + after}) - std::max(section.begin, middle - before));
        };
        std::array<double, 2>& target = state.steering[j].target = {};
        for (const physics::RodSection& section : command.sections) {
            const double length = inside(section, at) + (next == 0 ? inside(section, 0.0) : 0.0);
            for (std::size_t a = 0; a < 2; ++a) target[a] += length / (before + after) * section.curvature[a];
        }
    }
}

void steer(double dt, RodState& state)
{
    for (RodSteering& each : state.steering) {
        const double one = each.target[0] - each.now[0], two = each.target[1] - each.now[1];
        const double way = std::hypot(one, two), most = state.steeringRate * dt;
        if (way <= most)
            each.now = each.target;
        else
            each.now = {each.now[0] + most / way * one, each.now[1] + most / way * two};
    }
}

RodPlace placeAt(const RodState& state, std::span<const Vec3> x, std::size_t joint)
{
    const std::size_t nodes = x.size(), edges = state.directors.size();
    return {.x = {x[joint], x[wrapped(joint + 1, nodes)], x[wrapped(joint + 2, nodes)]},
            .directors = {state.directors[joint], state.directors[wrapped(joint + 1, edges)]},
            .twist = state.twists[joint]};
}

void moveRod(double dt, std::span<const Vec3> from, std::span<const Vec3> to, double seam, const RodState& state,
             RodState& out)
{
    const std::size_t edges = state.directors.size();
    out.directors.resize(edges);
    out.twists.resize(state.twists.size());
    for (std::size_t e = 0; e < edges; ++e) {
        const Vec3 now = directionOf(to, e);
        const Vec3 carried = transported(state.directors[e], directionOf(from, e), now);
        out.directors[e] = turnedAbout(now, carried, dt * out.spins[e]);
    }
    for (std::size_t j = 0; j < out.twists.size(); ++j)
        out.twists[j] = unwound(twistAt(to, out.directors, j) + (j + 1 == edges ? seam : 0.0), state.twists[j]);
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
    const std::size_t edges = isRing(rod) ? nodes : nodes - 1, joints = isRing(rod) ? edges : edges - 1;
    checkSize(object, "rod.edges", rod.edges.size(), edges);
    checkSize(object, "rod.inertias", rod.inertias.size(), edges);
    checkSize(object, "rod.joints", rod.joints.size(), joints);
    if (!rod.cut.empty()) checkSize(object, "rod.cut", rod.cut.size(), edges);
    if (!(rod.breakForce > 0.0)) fail(object, ": rod.breakForce must be > 0 N, got ", rod.breakForce);
    if (!rod.held.empty()) checkSize(object, "rod.held", rod.held.size(), edges);
    checkSize(object, "rod.directors", state.directors.size(), edges);
    checkSize(object, "rod.spins", state.spins.size(), edges);
    checkSize(object, "rod.twists", state.twists.size(), joints);
    checkSize(object, "rod.tensions", state.tensions.size(), edges);
    checkSize(object, "rod.plastic", state.plastic.size(), canYield(rod) ? joints : 0);
    if (!state.steering.empty()) checkSize(object, "rod.steering", state.steering.size(), joints);
    for (const RodSteering& each : state.steering)
        if (!std::isfinite(each.now[0] + each.now[1]) || !std::isfinite(each.target[0] + each.target[1]))
            fail(object, ": rod.steering must be finite");
    if (!(state.steeringRate > 0.0)) fail(object, ": rod.steeringRate must be > 0, got ", state.steeringRate);
    for (const RodCurvature& each : state.plastic)
        for (const auto& [one, two] : each)
            if (!std::isfinite(one + two)) fail(object, ": rod.plastic must be finite");
    if (!(rod.yieldCurvature > 0.0)) fail(object, ": rod.yieldCurvature must be > 0, got ", rod.yieldCurvature);
    if (!(rod.hardening >= 0.0) || !std::isfinite(rod.hardening))
        fail(object, ": rod.hardening must be >= 0, got ", rod.hardening);
    if (!std::isfinite(rod.seam)) fail(object, ": rod.seam must be finite");
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
