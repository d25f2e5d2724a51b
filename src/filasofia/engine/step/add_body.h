#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/commands.h"
#include "filasofia/physics/step.h"

namespace filasofia::engine {

/// Adds a built body and its attachments to the scene. The built body is moved out of the command.
void addBody(physics::AddBody& add, Scene& scene, physics::StepReport& report);

/// Removes a body and everything that refers to it: attachments, contacts and sides of sheets.
void removeBody(BodyId id, Scene& scene);

} // namespace filasofia::engine
