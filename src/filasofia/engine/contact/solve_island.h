#pragma once

#include "filasofia/engine/constraint/coupled_solve.h"
#include "filasofia/engine/contact/islands.h"
#include "filasofia/engine/rigid/articulation_step.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

namespace filasofia::engine {

struct Coupling;

/// Buffers of the coupled solves, kept from step to step.
struct IslandScratch {
    CoupledSolve solver;
    ConstraintRows rows;
    std::vector<int> pointOf;         ///< per node of the current body: its contact point, or -1
    std::vector<int> pieceOf;         ///< per node of the current body: its piece; empty if the body is whole
    std::vector<std::size_t> placeOf; ///< per unit (unitOf()) of the current island: its place in the island
};

/// Solves the equations of an island. Writes the change of velocities and the residual to the systems (dv, residual),
/// the changes of rigid bodies to the plans, and impulses and multipliers to the constraints. Soft bodies must be
/// assembled for the step, and the plan must hold the unconstrained changes.
CoupledReport solveIsland(const StepContext& context, const Island& island, const CoupledLimits& limits, Scene& scene,
                          Coupling& coupling);

} // namespace filasofia::engine
