#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

#include <span>

namespace filasofia::engine {

/// Applies what the outside asked for. The systems of bodies that a command changed are outdated then. `self`: the
/// engine, for tune().
void applyCommands(const StepContext& context, std::span<physics::Command> commands, physics::PhysicsEngine& self,
                   Scene& scene);

/// Rebuilds outdated systems, each once however many commands changed its body. `period` [s]: the step that they
/// prepare for.
void rebuildSystems(double period, Scene& scene);

} // namespace filasofia::engine
