#pragma once

#include "filasofia/engine/soft_system.h"
#include "filasofia/physics/physics_engine.h"

/// The stages of World::step. Each reads what comes first and writes what comes last; World::step only calls them.
namespace filasofia::engine {

using Systems = std::vector<SoftSystem>; ///< one per soft body, in the model's order

/// 1. What the outside asked for. `period` [s]: the step that solvers of changed bodies prepare for.
void applyCommands(std::span<physics::Command> commands, double period, physics::PhysicsEngine& self, Model& model,
                   State& state, Systems& systems, physics::StepReport& report);

/// 3. Forces and stiffness at the present state. Rotations are the only part of the state that it brings up to date.
void assemble(const Model& model, double dt, State& state, Systems& systems, WorkerPool& pool);

/// The same for one body, as if its masses were `inertia` times what they are.
void assembleBody(const SoftModel& model, Vec3 gravity, double dt, double inertia, SoftState& state, SoftSystem& system,
                  WorkerPool& pool);

/// 4. New velocities, new positions. A body whose new state is not finite is put back, at rest, and its step made again
/// with damping; where that fails too it stays where it is.
void advance(const Model& model, double dt, const physics::StepBudget* budget, Systems& systems, State& state,
             WorkerPool& pool, physics::StepReport& report);

} // namespace filasofia::engine
