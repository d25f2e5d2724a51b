#pragma once

#include "filasofia/physics/defs.h"

#include <cstdint>
#include <functional>

namespace filasofia::testing {

/// What the parts of a step of the default solver cost, each by itself, and how much they compute.
struct SolverCosts {
    int elements = 0;
    int nodes = 0;
    int coarseNodes = 0;         ///< of the two-level preconditioner; 0: block Jacobi alone
    double elementPass = 0.0;    ///< [s] rotations, forces, K v, rotated gradients, gathered by the nodes
    double product = 0.0;        ///< [s] K p, gathered by the nodes
    double preconditioner = 0.0; ///< [s]
    double flops = 0.0;          ///< [-] of floor(): floating point operations of the elements, counted by hand
    /// [s] what a step costs at least: one element pass, two products and one application of the preconditioner.
    [[nodiscard]] double floor() const { return elementPass + 2.0 * product + preconditioner; }
};

/// How the default solver is measured.
struct SolverCostsDef {
    Vec3 gravity;                      ///< [m/s^2]
    double period = 1e-3;              ///< [s], > 0
    int threads = 1;                   ///< [-], >= 1
    int warmUp = 0;                    ///< [-], >= 0, steps before
    int repeats = 1;                   ///< [-], > 0, of each part; its time is the median
    std::function<std::int64_t()> now; ///< [ns] a steady clock
};

/// Measures a body of elements with the default solver. Throws an Error if the body cannot be built or has another
/// solver.
SolverCosts measureSolver(const physics::SoftBodyDef& body, const SolverCostsDef& def);

} // namespace filasofia::testing
