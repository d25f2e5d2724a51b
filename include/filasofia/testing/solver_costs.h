#pragma once

#include "filasofia/physics/defs.h"

#include <cstdint>
#include <functional>

namespace filasofia::engine {

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

/// Measures a body of elements with the default solver: `warmUp` steps of `period` [s] under `gravity`, then `repeats`
/// of each part; medians. `now` [ns]: a steady clock. Throws an Error where the body cannot be built or has another
/// solver.
SolverCosts measureSolver(const physics::SoftBodyDef& def, Vec3 gravity, double period, int threads, int warmUp,
                          int repeats, const std::function<std::int64_t()>& now);

/// The instruction sets for which the inner loops are compiled and which this machine has, the best and used one first:
/// "AVX3" (AVX-512), "AVX2", "SSE4", "NEON", "EMU128" (plain code).
std::vector<std::string> simdTargets();

} // namespace filasofia::engine
