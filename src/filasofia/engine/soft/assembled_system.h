#pragma once

#include "filasofia/engine/body/soft_model.h"
#include "filasofia/engine/integration/euler.h"
#include "filasofia/linalg/block_sparse_matrix.h"
#include "filasofia/linalg/linear_solver.h"

#include <memory>

namespace filasofia::engine {

/// Largest lambda / mu that is solved in float, a Poisson ratio of 0.49992: beyond it the rounding errors of
/// compression are larger than shear. Measured with nodal volumes at 5e3: a beam that bends for 40 steps of 5 ms is
/// 2e-7 off. With volumes of elements, which round more, bunnies that spin and stretch were 5 % off there and blew up
/// at 5e4.
inline constexpr double kMaxLameRatio = 6e3;
/// True if an element exceeds that ratio: then neither the default solver nor conjugate gradients in double can solve
/// the body.
bool nearlyIncompressible(const SoftModel& model);

/// The equations of one step with every block of the matrix written out, in double precision.
struct AssembledSystem {
    explicit AssembledSystem(const SoftModel& model);

    /// Whether the matrix has all blocks that these elements need, whose tissue may have changed.
    [[nodiscard]] bool holds(const SoftModel& model, const std::vector<int>& elements) const;

    linalg::BlockSparseMatrix matrix; ///< the matrix of the implicit step
    /// Per element: place of its block (i, j) in the matrix; -1: a pinned node.
    std::vector<std::array<int, 16>> elementBlocks;
    std::vector<std::array<int, 4>> springBlocks; ///< the same per spring
    std::vector<int> diagonalBlocks;              ///< per node: place of its diagonal block
    std::vector<bool> sharing; ///< per element: the matrix has the blocks that its share in nodal volumes needs
    std::unique_ptr<linalg::LinearSolver> solver; ///< null if the integrator is explicit

    std::vector<Vec3> forces;                 ///< [N] all forces
    std::vector<Vec3> stiffnessTimesVelocity; ///< [N/s] K v
    std::vector<Vec3> rightHandSide;          ///< [N s]
};

/// Computes forces, matrix and right-hand side at a state and updates its rotations. `given` [N]: the forces other than
/// elasticity and damping. `inertia` [-] multiplies the masses in the matrix.
void assembleMatrix(const SoftModel& model, std::span<const Vec3> given, double dt, double inertia, SoftState& state,
                    AssembledSystem& system);

/// Solves for the change of the velocities. `dv` [m/s]: the first guess, then the result.
linalg::SolveReport solve(const SoftModel& model, double dt, double inertia, std::span<const Vec3> v,
                          AssembledSystem& system, std::span<Vec3> dv);

} // namespace filasofia::engine
