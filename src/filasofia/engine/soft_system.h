#pragma once

#include "filasofia/engine/model.h"
#include "filasofia/linalg/block_sparse_matrix.h"
#include "filasofia/linalg/linear_solver.h"

#include <array>
#include <memory>

namespace filasofia::engine {

/// One soft body's equations of one step, and the memory they are made in. Nothing here outlives a step but for speed:
/// all of it follows from the model.
struct SoftSystem {
    linalg::BlockSparseMatrix matrix;               ///< of the implicit step
    std::vector<std::array<int, 16>> elementBlocks; ///< where block (i, j) of each element goes; -1: a held node
    std::vector<std::array<int, 4>> springBlocks;   ///< the same for springs
    std::vector<int> diagonalBlocks;                ///< per node
    std::unique_ptr<linalg::LinearSolver> solver;   ///< nothing for explicit bodies

    std::vector<Vec3> forces;                 ///< [N] elastic, gravity, given, pins, dashpots
    std::vector<Vec3> stiffnessTimesVelocity; ///< [N/s] K v
    std::vector<Vec3> rightHandSide;          ///< [N s]
    std::vector<Vec3> x, v, dv;               ///< the new state, until it is known to be finite
};

SoftSystem makeSystem(const SoftModel& model);

} // namespace filasofia::engine
