#pragma once

#include "filasofia/scene/scene_def.h"

namespace filasofia::scene {

/// Gives the commands in the steps that end at their times. `ids`: the bodies of the scene. Throws an Error that begins
/// with a command's place if it cannot be given as far as can be told now: its body is of the wrong kind, or was
/// removed by a command before it.
void followCommands(runtime::Simulation& simulation, std::vector<TimedCommand> commands,
                    const std::vector<BodyId>& ids);

} // namespace filasofia::scene
