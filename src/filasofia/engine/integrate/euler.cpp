#include "filasofia/engine/integrate/euler.h"

namespace filasofia::engine {

void implicitRightHandSide(double dt, RayleighDamping rayleigh, std::span<const double> masses,
                           std::span<const Vec3> forces, std::span<const Vec3> stiffnessTimesVelocity,
                           std::span<const Vec3> v, const std::vector<bool>& fixed, std::span<Vec3> b)
{
    const double stiffness = implicitWeights(dt, rayleigh).stiffness;
    for (std::size_t i = 0; i < b.size(); ++i)
        b[i] = fixed[i] ? Vec3{}
                        : dt * (forces[i] - rayleigh.mass * masses[i] * v[i]) - stiffness * stiffnessTimesVelocity[i];
}

void advanceImplicit(double dt, std::span<const Vec3> dv, std::span<Vec3> x, std::span<Vec3> v)
{
    for (std::size_t i = 0; i < x.size(); ++i) {
        v[i] += dv[i];
        x[i] += dt * v[i];
    }
}

void advanceExplicit(double dt, bool symplectic, RayleighDamping rayleigh, std::span<const double> masses,
                     std::span<const Vec3> forces, std::span<const Vec3> stiffnessTimesVelocity,
                     const std::vector<bool>& fixed, std::span<Vec3> x, std::span<Vec3> v)
{
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (fixed[i]) continue;
        const Vec3 force =
            forces[i] - rayleigh.mass * masses[i] * v[i] - rayleigh.stiffness * stiffnessTimesVelocity[i];
        const Vec3 old = v[i];
        v[i] += dt / masses[i] * force;
        x[i] += dt * (symplectic ? v[i] : old);
    }
}

} // namespace filasofia::engine
