#pragma once

#include "filasofia/scene/scene_def.h"

namespace filasofia::scene {

/// An instrument of a scene; one of both pointers is set.
struct Instrument {
    BodyId body = {};
    std::shared_ptr<prefab::ArticulatedInstrument> jaws = {};
    std::shared_ptr<prefab::Endoscope> scope = {};
    bool keyed = false; ///< its own keys move it

    [[nodiscard]] bool isScope() const { return scope != nullptr; }
};
using Instruments = std::vector<Instrument>;

/// Adds a scene's instruments, and their bodies to `ids`; moves them before every step. The first endoscope gives the
/// picture if the scene has no cameras.
Instruments addInstruments(runtime::Simulation& simulation, const SceneDef& scene, std::vector<BodyId>& ids);

/// Lets the first button of a haptic interface that holds an instrument close its jaws. Throws an Error if the
/// interface cannot hold it.
void giveToHand(runtime::Simulation& simulation, const Instruments& instruments, BodyId held, runtime::HapticId hand);

} // namespace filasofia::scene
