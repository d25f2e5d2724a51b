#include "filasofia/engine/step/fill_cavities.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

using physics::CavityFill;

constexpr double kContraction = 0.61; // [-] for a jet from a sharp edge, pi / (pi + 2)

/// The nodes of a wall and the gradient of the volume inside, dV / dx = a third of the areas around a node: those of
/// the lids of its rims are left out, because nothing pushes there.
void gradientOf(const Cavity& cavity, std::span<const Vec3> x, CavityStiffness& out)
{
    std::vector<std::pair<int, Vec3>> parts;
    parts.reserve(3 * cavity.wall.size());
    for (const geometry::Triangle& t : cavity.wall) {
        const auto at = [&](std::size_t k) { return x[static_cast<std::size_t>(t[k])]; };
        const Vec3 third = 1.0 / 6.0 * cross(at(1) - at(0), at(2) - at(0));
        for (int node : t) parts.emplace_back(node, third);
    }
    std::ranges::stable_sort(parts, {}, &std::pair<int, Vec3>::first);
    out.nodes.clear();
    out.gradient.clear();
    for (const auto& [node, part] : parts) {
        if (out.nodes.empty() || out.nodes.back() != node) {
            out.nodes.push_back(node);
            out.gradient.emplace_back();
        }
        out.gradient.back() += part;
    }
}

/// The pressure of a liquid is given at the middle of its wall, and grows downwards from there.
void addWeight(const Cavity& cavity, Vec3 gravity, std::span<const Vec3> x, std::vector<Vec3>& forces)
{
    const auto middle = [&](const geometry::Triangle& t) {
        return 1.0 / 3.0 *
               (x[static_cast<std::size_t>(t[0])] + x[static_cast<std::size_t>(t[1])] +
                x[static_cast<std::size_t>(t[2])]);
    };
    Vec3 centre;
    for (const geometry::Triangle& t : cavity.wall) centre += middle(t);
    centre = 1.0 / static_cast<double>(cavity.wall.size()) * centre;
    const Vec3 perMetre = densityOf(cavity) * gravity;
    for (const geometry::Triangle& t : cavity.wall) {
        const auto at = [&](std::size_t k) { return x[static_cast<std::size_t>(t[k])]; };
        const Vec3 third = dot(perMetre, middle(t) - centre) / 6.0 * cross(at(1) - at(0), at(2) - at(0));
        for (int node : t) forces[static_cast<std::size_t>(node)] += third;
    }
}

/// Lets flow out, or in, what a step's time and the difference of pressure allow. Returns the flow at the cavity's
/// pressure [m^3/s], outwards.
double leak(double dt, const Cavity& cavity, double opening, double volume, CavityState& state)
{
    const double pressure = pressureIn(cavity, state, volume).pressure;
    const double speed = std::sqrt(2.0 * std::abs(pressure) / std::max(densityOf(cavity), 1e-3));
    const double flow = std::copysign(kContraction * opening * speed, pressure);
    if (cavity.def.fill == CavityFill::Source) {
        state.lost += flow * dt;
        return flow;
    }
    const bool gas = cavity.def.fill == CavityFill::Gas;
    const double perVolume = !gas ? 1.0 : flow > 0.0 ? pressure + physics::kAtmosphere : physics::kAtmosphere;
    const double even = contentAt(cavity, 0.0, volume); // both pressures are the same: no flow goes beyond
    const double next = state.content - perVolume * flow * dt;
    const double before = std::exchange(state.content, flow > 0.0 ? std::max(next, std::min(even, state.content))
                                                                  : std::min(next, std::max(even, state.content)));
    const double out = before - state.content;
    state.lost += gas ? out / physics::kAtmosphere : out;
    return dt > 0.0 ? out / (perVolume * dt) : 0.0;
}

frame::Cavity fillCavity(double dt, const Cavity& cavity, std::span<const Vec3> x, CavityState& state)
{
    const bool gas = cavity.def.fill == CavityFill::Gas;
    state.content = std::max(0.0, state.content + dt * state.inflow * (gas ? physics::kAtmosphere : 1.0));
    frame::Cavity report{.volume = volumeOf(cavity, x), .open = cavity.isOpen()};
    if (report.open) {
        report.opening = openingOf(cavity, x);
        report.outflow = leak(dt, cavity, report.opening, report.volume, state);
    }
    report.pressure = pressureIn(cavity, state, report.volume).pressure;
    report.lost = state.lost;
    return report;
}

} // namespace

void addCavityForces(const CavityStep& step, const SoftModel& model, const SoftState& state, std::vector<Vec3>& forces,
                     std::vector<CavityStiffness>& out)
{
    out.resize(model.cavities.size());
    for (std::size_t c = 0; c < out.size(); ++c) {
        const Cavity& cavity = model.cavities[c];
        CavityStiffness& add = out[c];
        gradientOf(cavity, state.x, add);
        const auto [pressure, stiffness] = pressureIn(cavity, state.cavities[c], volumeOf(cavity, state.x));
        double growth = 0.0; // [m^3/s]
        for (std::size_t i = 0; i < add.nodes.size(); ++i)
            growth += dot(add.gradient[i], state.v[static_cast<std::size_t>(add.nodes[i])]);
        add.weight = step.dt * step.dt * stiffness;
        const double push = pressure - step.dt * stiffness * growth;
        for (std::size_t i = 0; i < add.nodes.size(); ++i)
            forces[static_cast<std::size_t>(add.nodes[i])] += push * add.gradient[i];
        if (cavity.def.fill == CavityFill::Liquid && model.gravity && !cavity.wall.empty())
            addWeight(cavity, step.gravity, state.x, forces);
    }
}

void fillCavities(double dt, Scene& scene)
{
    scene.cavityReports.clear();
    for (SoftBody& body : scene.soft)
        for (std::size_t c = 0; c < body.model.cavities.size(); ++c) {
            frame::Cavity report = fillCavity(dt, body.model.cavities[c], body.state.x, body.state.cavities[c]);
            report.body = body.model.id;
            report.cavity = static_cast<int>(c);
            scene.cavityReports.push_back(report);
        }
}

} // namespace filasofia::engine
