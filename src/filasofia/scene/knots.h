#pragma once

#include "filasofia/scene/scene_def.h"

namespace filasofia::scene {

/// Adds the hands that tie a scene's knots, and lets them begin and let go at their times. Returns how far each is.
std::vector<std::function<SceneKnotProgress()>> addKnots(runtime::Simulation& simulation, const SceneDef& scene,
                                                         const std::vector<BodyId>& ids);

} // namespace filasofia::scene
