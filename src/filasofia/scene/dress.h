#pragma once

#include "filasofia/scene/scene_def.h"

namespace filasofia::scene {

/// Gives a simulation the cameras, lights and views of a scene, if it has cameras. `ids`: the bodies of the scene.
/// Throws an Error if one names a camera that is not there, or if there are lights without a camera.
void dressScene(runtime::Simulation& simulation, const SceneDef& scene, const std::vector<BodyId>& ids);

} // namespace filasofia::scene
