#include "filasofia/engine/integration/euler.h"

namespace filasofia::engine {

void implicitRightHandSide(double dt, RayleighDamping rayleigh, const NodeState& nodes, std::span<Vec3> b)
{
    const auto& [masses, forces, stiffnessTimesVelocity, v, fixed] = nodes;
    const double stiffness = implicitWeights(dt, rayleigh).stiffness;
    for (std::size_t i = 0; i < b.size(); ++i)
        b[i] = fixed[i] ? Vec3{}
                        : dt * (forces[i] - rayleigh.mass * masses[i] * v[i]) - stiffness * stiffnessTimesVelocity[i];
}

void explicitChange(double dt, RayleighDamping rayleigh, double inertia, const NodeState& nodes, std::span<Vec3> dv)
{
    const auto& [masses, forces, stiffnessTimesVelocity, v, fixed] = nodes;
    for (std::size_t i = 0; i < dv.size(); ++i) {
        const Vec3 force =
            forces[i] - rayleigh.mass * masses[i] * v[i] - rayleigh.stiffness * stiffnessTimesVelocity[i];
        dv[i] = fixed[i] ? Vec3{} : dt / (inertia * masses[i]) * force;
    }
}

void move(double dt, bool withOldVelocity, std::span<const Vec3> dv, std::span<Vec3> x, std::span<Vec3> v)
{
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Vec3 old = v[i];
        v[i] += dv[i];
        x[i] += dt * (withOldVelocity ? old : v[i]);
    }
}

} // namespace filasofia::engine
