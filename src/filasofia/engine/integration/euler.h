#pragma once

#include "filasofia/linalg/linear_solver.h"

#include <span>
#include <vector>

/// One step of M x'' = f(x, v) for nodes with lumped masses; nodes marked `fixed` keep position and velocity.
namespace filasofia::engine {

/// Rayleigh damping C = mass M + stiffness K.
struct RayleighDamping {
    double mass = 0.0;      ///< [1/s]
    double stiffness = 0.0; ///< [s]
};

/// How the implicit step weighs what it is made of (Baraff and Witkin 1998, with Rayleigh damping):
///     ( (1 + h a) M + (h^2 + h b) K + h D ) dv = h (f - a M v - b K v - D v) - h^2 K v
/// f without damping, K = -df/dx, D = -df/dv of dashpots, a and b Rayleigh's coefficients. What of K is geometric
/// damps nothing: a body in tension may turn.
struct ImplicitWeights {
    double mass = 1.0;      ///< of M in the matrix
    double stiffness = 0.0; ///< of K in the matrix, and of K v on the right-hand side
    double damping = 0.0;   ///< of D in the matrix
    double turning = 0.0;   ///< [-] of the geometric part of K, by `stiffness`
};
constexpr ImplicitWeights implicitWeights(double dt, RayleighDamping rayleigh)
{
    const double stiffness = dt * dt + dt * rayleigh.stiffness;
    return {1.0 + dt * rayleigh.mass, stiffness, dt, stiffness > 0.0 ? dt * dt / stiffness : 0.0};
}

/// The same sum for a step without a matrix but the masses: M dv = h (f - a M v - b K v - D v).
constexpr ImplicitWeights explicitWeights(double dt, RayleighDamping rayleigh)
{
    return {1.0, dt * rayleigh.stiffness, dt, 0.0};
}

/// The right-hand side above; `forces` holds f - D v. Zero on fixed nodes.
void implicitRightHandSide(double dt, RayleighDamping rayleigh, std::span<const double> masses,
                           std::span<const Vec3> forces, std::span<const Vec3> stiffnessTimesVelocity,
                           std::span<const Vec3> v, const std::vector<bool>& fixed, std::span<Vec3> b);

/// dv = dt M^-1 (f - a M v - b K v), the masses in M^-1 alone taken `inertia` times.
void explicitChange(double dt, RayleighDamping rayleigh, double inertia, std::span<const double> masses,
                    std::span<const Vec3> forces, std::span<const Vec3> stiffnessTimesVelocity, std::span<const Vec3> v,
                    const std::vector<bool>& fixed, std::span<Vec3> dv);

/// v' = v + dv, x' = x + dt v', or x + dt v for the plain explicit step.
void move(double dt, bool withOldVelocity, std::span<const Vec3> dv, std::span<Vec3> x, std::span<Vec3> v);

} // namespace filasofia::engine
