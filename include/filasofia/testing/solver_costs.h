#pragma once

#include "filasofia/physics/defs.h"

#include <cstdint>
#include <functional>

namespace filasofia::testing {

/// The time of each part of a step of the default solver, measured by itself, and the number of operations.
struct SolverCosts {
    int elements = 0;
    int nodes = 0;
    int coarseNodes = 0;         ///< coarse nodes of the two-level preconditioner; 0: block Jacobi alone
    double elementPass = 0.0;    ///< [s] rotations, forces, K v and rotated gradients, gathered at the nodes
    double product = 0.0;        ///< [s] K p, gathered at the nodes
    double preconditioner = 0.0; ///< [s] one application of the preconditioner
    double flops = 0.0;          ///< [-] floating-point operations of the elements in floor(), counted by hand
    /// [s] The lower bound of a step: one element pass, two products and one application of the preconditioner.
    [[nodiscard]] double floor() const { return elementPass + 2.0 * product + preconditioner; }
};

/// The parameters of a measurement of the default solver.
struct SolverCostsDef {
    Vec3 gravity;                      ///< [m/s^2]
    double period = 1e-3;              ///< [s], > 0
    int threads = 1;                   ///< [-], >= 1
    int warmUp = 0;                    ///< [-], >= 0: steps before the measurement
    int repeats = 1;                   ///< [-], > 0: measurements of each part, of which the median counts
    std::function<std::int64_t()> now; ///< [ns] a steady clock
};

/// Measures a FEM body with the default solver. Throws an Error if the body cannot be built or has another material,
/// solver or integrator.
SolverCosts measureSolver(const physics::SoftBodyDef& body, const SolverCostsDef& def);

} // namespace filasofia::testing
