#pragma once

#include "filasofia/engine/constraint/coupled_solve.h"
#include "filasofia/engine/contact/islands.h"
#include "filasofia/engine/rigid/articulation_step.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

namespace filasofia::engine {

struct Coupling;

/// Memory that coupled solves are made in, kept from step to step.
struct IslandScratch {
    CoupledSolve solver;
    ConstraintRows rows;
    std::vector<int> pointOf; ///< per node of the body being looked at: its contact point, or -1
    std::vector<int> pieceOf; ///< the same: which of its pieces it is in; empty if the body is whole
};

/// Solves the equations of an island: leaves the change of velocities in the systems (dv, leftover) and in the plans,
/// and impulses and multipliers in the constraints. Soft bodies are assembled for the step; the plan holds the free
/// changes.
CoupledReport solveIsland(const StepContext& context, const Island& island, const CoupledLimits& limits, Scene& scene,
                          Coupling& coupling);

} // namespace filasofia::engine
