#pragma once

#include "filasofia/engine/rigid/articulation_step.h"
#include "filasofia/engine/constraint/coupled_solve.h"
#include "filasofia/engine/contact/islands.h"
#include "filasofia/engine/soft/soft_system.h"

namespace filasofia::engine {

/// Memory that coupled solves are made in, kept from step to step.
struct IslandScratch {
    CoupledSolve solver;
    Constraints constraints;
    std::vector<int> gripOf;  ///< per node of the body being looked at: its grip, or -1
    std::vector<int> pieceOf; ///< the same: which of its pieces it is in; empty where the body is whole
};

/// Solves the equations of an island: leaves the change of velocities in the systems (dv, leftover) and in the plans,
/// and the impulses in the links. Soft bodies are assembled for the step; the plan holds the free changes.
CoupledReport solveIsland(const Model& model, const State& state, double dt, const Island& island,
                          const CoupledLimits& limits, std::vector<SoftSystem>& systems, RigidPlan& plan,
                          ArticulationPlans& articulations, std::vector<Link>& links, IslandScratch& scratch,
                          WorkerPool& pool);

} // namespace filasofia::engine
