#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/physics_engine.h"

namespace filasofia::engine {

/// Lets the user change the scene (native/native.h) and then checks all of it as if it had just been built. If the
/// change throws or leaves something invalid, the scene is restored, an error is logged, and the report has
/// StepFlag::TuneRejected.
void tuneScene(const physics::Tune& tune, physics::PhysicsEngine& self, Scene& scene, physics::StepReport& report);

} // namespace filasofia::engine
