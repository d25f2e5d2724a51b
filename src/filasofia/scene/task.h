#pragma once

#include "filasofia/scene/scene_def.h"

namespace filasofia::scene {

/// The task with a name for each step; throws an Error that begins with "task" if two have the same one.
SceneTask withNames(SceneTask task);

/// Starts a scene's task, with its instructions over the picture; the run ends when it is over. `ids`: the bodies of
/// the scene; `tracker` gets the steps, and may be null; `arrow`: the picture is made by dress(), so an arrow may point
/// in it. Throws an Error that begins with "task".
std::shared_ptr<const prefab::Task> addTask(runtime::Simulation& simulation, const SceneTask& task,
                                            const std::vector<BodyId>& ids, prefab::MetricTracker* tracker, bool arrow);

/// Starts to observe what a scene measures; null if `def` names no file and keeps nothing.
std::shared_ptr<prefab::MetricTracker> addTracker(runtime::Simulation& simulation, const SceneDef& scene,
                                                  const std::vector<BodyId>& ids, prefab::MetricTrackerDef def);

} // namespace filasofia::scene
