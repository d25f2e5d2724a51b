#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/commands.h"
#include "filasofia/physics/step.h"

namespace filasofia::engine {

/// Takes a built body into the scene, with its attachments. What was built is moved out of the command.
void addBody(physics::AddBody& add, Scene& scene, physics::StepReport& report);

/// Removes a body and all that refers to it: attachments, contacts, sides.
void removeBody(BodyId id, Scene& scene);

} // namespace filasofia::engine
