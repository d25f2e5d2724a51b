#include "filasofia/engine/step/fill_cavities.h"

#include "filasofia/core/log.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

using physics::CavityFill;

constexpr double kContraction = 0.61;  // [-] for a jet from a sharp edge, pi / (pi + 2)
constexpr double kLeastPressure = 1.0; // [Pa] below it, the flow is proportional to the pressure

Vec3 middleOf(const geometry::Triangle& t, std::span<const Vec3> x)
{
    const auto at = [&](std::size_t k) { return x[static_cast<std::size_t>(t[k])]; };
    return 1.0 / 3.0 * (at(0) + at(1) + at(2));
}

/// Sums of parts per node.
struct NodeSums {
    std::vector<Vec3> of;
    std::vector<char> has;
    void add(int node, Vec3 part)
    {
        of[static_cast<std::size_t>(node)] += part;
        has[static_cast<std::size_t>(node)] = 1;
    }
};

/// What a rim's lid adds to the gradient: triangles (b, a, middle), whose middle moves with all nodes of the rim.
void addLid(const CavityRim& rim, std::span<const Vec3> x, NodeSums& sums)
{
    const Vec3 middle = middleOf(rim, x);
    Vec3 lid;
    for (const auto& [a, b] : rim.edges) {
        const Vec3 from = x[static_cast<std::size_t>(b)];
        const Vec3 area = 0.5 * cross(x[static_cast<std::size_t>(a)] - from, middle - from);
        for (int node : {a, b}) sums.add(node, 1.0 / 3.0 * area);
        lid += area;
    }
    const double share = 1.0 / (3.0 * static_cast<double>(rim.edges.size()));
    for (const auto& [a, b] : rim.edges) sums.add(a, share * lid);
}

/// The gradient of volumeOf(), lids included. It sums up to zero over each part that is closed with its lids, so no
/// motion of a part as a whole changes the volume.
void gradientOf(const Cavity& cavity, std::span<const Vec3> x, RankOneStiffness& out)
{
    NodeSums sums{std::vector<Vec3>(x.size()), std::vector<char>(x.size())};
    for (const geometry::Triangle& t : cavity.wall) {
        const Vec3 third = 1.0 / 3.0 * areaOf(t, x);
        for (int node : t) sums.add(node, third);
    }
    for (const CavityRim& rim : cavity.rims) addLid(rim, x, sums);
    out.nodes.clear();
    out.gradient.clear();
    for (std::size_t node = 0; node < x.size(); ++node) {
        if (sums.has[node] == 0) continue;
        out.nodes.push_back(static_cast<int>(node));
        out.gradient.push_back(sums.of[node]);
    }
}

/// [m] Where the pressure of a liquid is that of its fill: at the openings, otherwise in the middle of the wall.
Vec3 levelOf(const Cavity& cavity, std::span<const Vec3> x)
{
    Vec3 sum;
    double weight = 0.0;
    for (const CavityRim& rim : cavity.rims) {
        const auto edges = static_cast<double>(rim.edges.size());
        sum += edges * middleOf(rim, x);
        weight += edges;
    }
    if (cavity.rims.empty())
        for (const geometry::Triangle& t : cavity.wall) {
            const double area = length(areaOf(t, x));
            sum += area * middleOf(t, x);
            weight += area;
        }
    return weight > 0.0 ? 1.0 / weight * sum : middleOf(cavity.wall.front(), x);
}

/// The pressure on the wall, which for a liquid grows downwards from its level. Nothing pushes on the lids.
void addPressure(const Cavity& cavity, double pressure, Vec3 gravity, std::span<const Vec3> x,
                 std::vector<Vec3>& forces)
{
    const bool heavy = cavity.def.fill == CavityFill::Liquid;
    const Vec3 level = heavy ? levelOf(cavity, x) : Vec3{}, perMetre = densityOf(cavity) * gravity;
    for (const geometry::Triangle& t : cavity.wall) {
        const double here = heavy ? pressure + dot(perMetre, middleOf(t, x) - level) : pressure;
        const Vec3 third = here / 3.0 * areaOf(t, x);
        for (int node : t) forces[static_cast<std::size_t>(node)] += third;
    }
}

/// Lets flow out, or in, what the step's pressure drives through the openings. Returns the flow at the cavity's
/// pressure [m^3/s], outwards.
double leak(double dt, const Cavity& cavity, double pressure, CavityState& state)
{
    const double flow = state.conductance * pressure;
    const bool gas = cavity.def.fill == CavityFill::Gas;
    const double perVolume = !gas ? 1.0 : physics::kAtmosphere + std::max(pressure, 0.0);
    const double out =
        cavity.def.fill == CavityFill::Source ? flow * dt : std::min(perVolume * flow * dt, state.content);
    if (cavity.def.fill != CavityFill::Source) state.content -= out;
    state.lost += gas ? out / physics::kAtmosphere : out;
    return flow;
}

// [-] Of the volume at the start: flatter than that, walls may pass through each other unless they collide with each
// other, and a wall that has grown so much is no tissue.
constexpr double kEmpty = 0.02, kBursting = 20.0;

/// Whether its own surface, which has the walls of its cavities, collides with itself.
bool collidesWithItself(const SoftModel& model)
{
    return std::ranges::any_of(model.collision, [&](const CollisionModel& each) {
        const bool cut = model.opened && each.shape->closed && each.selfOnceCut;
        return each.own && (each.shape->self || cut);
    });
}

void warn(const SoftModel& model, const frame::Cavity& now, double restVolume, CavityState& state)
{
    const bool empty = now.volume < kEmpty * restVolume && !collidesWithItself(model);
    const bool bursting = now.volume > kBursting * restVolume;
    if ((empty || bursting) && !std::exchange(state.warned, true))
        logWarning(describe(model), ": cavities[", now.cavity, "] ",
                   empty ? "is empty: without self-collision its walls may pass through each other"
                         : "has grown to 20 times its volume: in tissue it would have burst");
}

frame::Cavity endStep(double dt, const Cavity& cavity, std::span<const Vec3> x, CavityState& state)
{
    if (cavity.wall.empty()) return {.open = true, .lost = state.lost}; // all of it was removed
    frame::Cavity report{.volume = volumeOf(cavity, x), .open = cavity.isOpen()};
    report.pressure = state.last = pressureIn(cavity, state, report.volume, dt).pressure;
    if (report.open) {
        report.opening = openingOf(cavity, x);
        report.outflow = leak(dt, cavity, report.pressure, state);
    }
    report.lost = state.lost;
    return report;
}

} // namespace

void fillCavities(double dt, Scene& scene)
{
    for (SoftBody& body : scene.soft)
        for (std::size_t c = 0; c < body.model.cavities.size(); ++c) {
            const Cavity& cavity = body.model.cavities[c];
            CavityState& state = body.state.cavities[c];
            if (cavity.wall.empty()) continue;
            const double perVolume = cavity.def.fill == CavityFill::Gas ? physics::kAtmosphere : 1.0;
            state.content = std::max(0.0, state.content + dt * state.inflow * perVolume);
            const double pressure = cavity.def.fill == CavityFill::Source ? state.pressure : state.last;
            state.conductance =
                cavity.isOpen()
                    ? kContraction * openingOf(cavity, body.state.x) *
                          std::sqrt(2.0 / (densityOf(cavity) * std::max(std::abs(pressure), kLeastPressure)))
                    : 0.0;
        }
}

void addCavityForces(const CavityStep& step, const SoftModel& model, const SoftState& state, std::vector<Vec3>& forces,
                     std::vector<RankOneStiffness>& out)
{
    out.resize(model.cavities.size());
    for (std::size_t c = 0; c < out.size(); ++c) {
        const Cavity& cavity = model.cavities[c];
        RankOneStiffness& add = out[c];
        gradientOf(cavity, state.x, add);
        add.weight = 0.0;
        if (cavity.wall.empty()) continue;
        const auto [pressure, stiffness] = pressureIn(cavity, state.cavities[c], volumeOf(cavity, state.x), step.dt);
        addPressure(cavity, pressure, model.gravity ? step.gravity : Vec3{}, state.x, forces);
        double growth = 0.0; // [m^3/s]
        for (std::size_t i = 0; i < add.nodes.size(); ++i)
            growth += dot(add.gradient[i], state.v[static_cast<std::size_t>(add.nodes[i])]);
        add.weight = step.dt * step.dt * stiffness;
        const double resists = -step.dt * stiffness * growth;
        for (std::size_t i = 0; i < add.nodes.size(); ++i)
            forces[static_cast<std::size_t>(add.nodes[i])] += resists * add.gradient[i];
    }
}

void drainCavities(double dt, Scene& scene)
{
    scene.cavityReports.clear();
    for (SoftBody& body : scene.soft)
        for (std::size_t c = 0; c < body.model.cavities.size(); ++c) {
            const Cavity& cavity = body.model.cavities[c];
            frame::Cavity report = endStep(dt, cavity, body.state.x, body.state.cavities[c]);
            report.body = body.model.id;
            report.cavity = static_cast<int>(c);
            warn(body.model, report, cavity.restVolume, body.state.cavities[c]);
            scene.cavityReports.push_back(report);
        }
}

} // namespace filasofia::engine
