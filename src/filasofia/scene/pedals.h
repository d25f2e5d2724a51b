#pragma once

#include "filasofia/scene/instruments.h"

namespace filasofia::scene {

/// The haptic interfaces of a scene, each with the body that it holds.
using Hands = std::vector<std::pair<runtime::HapticId, BodyId>>;

/// Adds the electrodes of a body; those that name another body mean one of those before it.
void addElectrodes(runtime::Simulation& simulation, BodyId id, const std::vector<surface::ElectrodeDef>& electrodes,
                   const std::vector<BodyId>& before);

/// Throws an Error that begins with `place` if a body has no such electrode.
void checkElectrode(const runtime::Simulation& simulation, BodyId id, int electrode, const std::string& place);

/// Lets keys and buttons activate electrodes, open suction of smoke, and let instruments rinse.
void followPedals(runtime::Simulation& simulation, const SceneDef& scene, const std::vector<BodyId>& ids,
                  const Instruments& instruments, const Hands& hands);

} // namespace filasofia::scene
