#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

#include <span>

namespace filasofia::engine {

/// Applies the commands of a step in their order. If a command changes a body's model, it marks the body's system as
/// outdated. `self`: the engine, for tune().
void applyCommands(const StepContext& context, std::span<physics::Command> commands, physics::PhysicsEngine& self,
                   Scene& scene);

/// Rebuilds outdated systems, each once per step even if several commands changed its body. `period` [s]: the step that
/// they prepare for.
void rebuildSystems(double period, Scene& scene);

} // namespace filasofia::engine
