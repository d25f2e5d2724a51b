#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

/// Clips: what they press, and how they are attached.
namespace filasofia::engine {

/// Puts a clip onto the tissue that is between its legs now. Nothing there: a flag, and a warning in the log.
void applyClip(const physics::ApplyClip& command, Scene& scene, physics::StepReport& report);

/// Before the constraints are collected: how far clips are closed in this step, and with what force at its start. Clips
/// whose attachment was released are gone.
void closeClips(double dt, Scene& scene);

/// After the attachments: clips that were pulled off are gone, and all others reported.
void keepClips(Scene& scene, physics::StepReport& report);

} // namespace filasofia::engine
