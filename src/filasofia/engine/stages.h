#pragma once

#include "filasofia/engine/soft_system.h"
#include "filasofia/physics/physics_engine.h"

/// The stages of World::step. Each reads what comes first and writes what comes last; World::step only calls them.
namespace filasofia::engine {

using Systems = std::vector<SoftSystem>; ///< one per soft body, in the model's order

/// 1. What the outside asked for.
void applyCommands(std::span<physics::Command> commands, physics::PhysicsEngine& self, Model& model, State& state,
                   Systems& systems, physics::StepReport& report);

/// 3. Forces and stiffness at the present state. Rotations are the only part of the state that it brings up to date.
void assemble(const Model& model, double dt, State& state, Systems& systems);

/// 4. New velocities, new positions. A body whose new state is not finite is put back, at rest.
void advance(const Model& model, double dt, Systems& systems, State& state, physics::StepReport& report);

} // namespace filasofia::engine
