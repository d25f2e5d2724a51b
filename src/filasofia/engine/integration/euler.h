#pragma once

#include "filasofia/linalg/linear_solver.h"

#include <span>
#include <vector>

/// One step of M x'' = f(x, v) for nodes with lumped masses. Nodes marked `fixed` keep their position and velocity.
namespace filasofia::engine {

/// Rayleigh damping C = mass M + stiffness K.
struct RayleighDamping {
    double mass = 0.0;      ///< [1/s]
    double stiffness = 0.0; ///< [s]
};

/// The weights of the implicit step (Baraff and Witkin 1998, with Rayleigh damping):
///     ( (1 + h a) M + (h^2 + h b) K + h D ) dv = h (f - a M v - b K v - D v) - h^2 K v
/// with
///     h     [s] time step
///     f     [N] forces without damping
///     K, D  [N/m] -df/dx, [N s/m] -df/dv of dashpots
///     a, b  [1/s], [s] Rayleigh's coefficients
/// The geometric part of K takes no part in damping: a body in tension may turn freely. If the tissue relaxes, the
/// stress of its law changes by a share A of K within a step, and its part of the matrix is (A h^2 + h b) K.
struct ImplicitWeights {
    double mass = 1.0;       ///< weight of M in the matrix
    double stiffness = 0.0;  ///< weight of K in the matrix, and of K v on the right-hand side
    double damping = 0.0;    ///< weight of D in the matrix
    double turning = 0.0;    ///< [-] weight of the geometric part of K, relative to `stiffness`
    double law = 0.0;        ///< weight of the K of an elastic law, in place of `stiffness`
    double lawTurning = 0.0; ///< [-] weight of its geometric part, relative to `law`
};
/// `relaxing` [-]: A.
constexpr ImplicitWeights implicitWeights(double dt, RayleighDamping rayleigh, double relaxing = 1.0)
{
    const double square = dt * dt, damped = dt * rayleigh.stiffness;
    const double stiffness = square + damped, law = relaxing * square + damped;
    return {.mass = 1.0 + dt * rayleigh.mass,
            .stiffness = stiffness,
            .damping = dt,
            .turning = stiffness > 0.0 ? square / stiffness : 0.0,
            .law = law,
            .lawTurning = law > 0.0 ? relaxing * square / law : 0.0};
}

/// The weights of the explicit step, whose matrix is the masses alone: M dv = h (f - a M v - b K v - D v).
constexpr ImplicitWeights explicitWeights(double dt, RayleighDamping rayleigh)
{
    const double damped = dt * rayleigh.stiffness;
    return {.mass = 1.0, .stiffness = damped, .damping = dt, .turning = 0.0, .law = damped, .lawTurning = 0.0};
}

/// The nodes at the start of a step.
struct NodeState {
    std::span<const double> masses;               ///< [kg]
    std::span<const Vec3> forces;                 ///< [N] f - D v
    std::span<const Vec3> stiffnessTimesVelocity; ///< [N/s] K v
    std::span<const Vec3> v;                      ///< [m/s]
    const std::vector<bool>& fixed;
};

/// Computes the right-hand side above. Zero on fixed nodes.
void implicitRightHandSide(double dt, RayleighDamping rayleigh, const NodeState& nodes, std::span<Vec3> b);

/// dv = dt M^-1 (f - a M v - b K v). Only the masses in M^-1 are multiplied by `inertia`.
void explicitChange(double dt, RayleighDamping rayleigh, double inertia, const NodeState& nodes, std::span<Vec3> dv);

/// v' = v + dv, and x' = x + dt v', or x' = x + dt v for the plain explicit step.
void move(double dt, bool withOldVelocity, std::span<const Vec3> dv, std::span<Vec3> x, std::span<Vec3> v);

} // namespace filasofia::engine
