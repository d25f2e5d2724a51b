#pragma once

#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/integration/euler.h"
#include "filasofia/linalg/block_sparse_matrix.h"
#include "filasofia/linalg/linear_solver.h"

#include <memory>

namespace filasofia::engine {

/// lambda / mu beyond which compression, rounded to float, drowns shear: a Poisson ratio of 0.49983. Measured on
/// bunnies that spin and stretch, at 5 ms: well at 2.5e3, 5 % off at 5e3, blown up at 5e4.
inline constexpr double kMostIncompressible = 3e3;
/// True where an element lies beyond: neither the default solver nor conjugate gradients in double can have the body.
bool nearlyIncompressible(const SoftModel& model);

/// The equations of one step with every block of the matrix written out, in double precision.
struct AssembledSystem {
    explicit AssembledSystem(const SoftModel& model);

    linalg::BlockSparseMatrix matrix;               ///< of the implicit step
    std::vector<std::array<int, 16>> elementBlocks; ///< where block (i, j) of each element goes; -1: a held node
    std::vector<std::array<int, 4>> springBlocks;   ///< the same for springs
    std::vector<int> diagonalBlocks;                ///< per node
    std::unique_ptr<linalg::LinearSolver> solver;   ///< nothing for explicit bodies

    std::vector<Vec3> forces;                 ///< [N] all of them
    std::vector<Vec3> stiffnessTimesVelocity; ///< [N/s] K v
    std::vector<Vec3> rightHandSide;          ///< [N s]
};

/// Forces, matrix and right-hand side at a state; its rotations are brought up to date. `given` [N]: what acts without
/// any deformation. `inertia` multiplies the masses in the matrix.
void assembleMatrix(const SoftModel& model, std::span<const Vec3> given, double dt, double inertia, SoftState& state,
                    AssembledSystem& system);

/// The change of the velocities from them, `dv` holding the first guess.
linalg::SolveReport solve(const SoftModel& model, double dt, double inertia, std::span<const Vec3> v,
                          AssembledSystem& system, std::span<Vec3> dv);

} // namespace filasofia::engine
