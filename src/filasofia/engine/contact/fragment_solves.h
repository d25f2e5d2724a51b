#pragma once

#include "filasofia/engine/constraint/coupled_solve.h"
#include "filasofia/engine/rigid/rigid_step.h"

#include <vector>

namespace filasofia::engine {

/// A small fragment of a soft body that acts on nothing which constraints could move. It is solved apart from its body,
/// exactly: it is so light, and so stiff for its mass, that the body's preconditioner knows nothing of its contacts. In
/// one solve, six fragments of two elements on a floor beside 5,600 elements keep steps at 300 iterations for ever;
/// apart, steps take 8.
struct FragmentSolve {
    std::size_t body = 0;                 ///< index among the soft bodies
    std::size_t piece = 0;                ///< index in SoftModel::pieces
    std::vector<std::size_t> constraints; ///< indices in the list of constraints, ascending
    std::vector<Vec3> impulses = {};      ///< [N s] per node of the piece: the right-hand side
};

struct FragmentSolves {
    std::vector<FragmentSolve> list; ///< by body and piece, ascending
    std::vector<char> apart;         ///< per constraint: whether it is in one of these solves
};

FragmentSolves findFragmentSolves(const Scene& scene, const RigidPlan& plan, std::span<const Constraint> constraints);

/// Takes the fragment out of the solve of its body, which must be assembled for the step.
void setAside(FragmentSolve& fragment, SoftBody& body);

/// Solves for the change of velocities, after the solve of the body: writes that of these nodes (dv) and their residual
/// to the body's system, and impulses and multipliers to the constraints. A fragment changes its shape by at most half
/// of its size in a step. If its matrix is not positive definite to rounding, it moves as if it were dust, and the
/// report has not converged.
CoupledReport solveFragment(double dt, const CoupledLimits& limits, const FragmentSolve& fragment, SoftBody& body,
                            std::span<Constraint> constraints, CoupledSolve& solver);

} // namespace filasofia::engine
