#pragma once

#include "filasofia/prefab/trocar_hands.h"
#include "filasofia/scene/scene_def.h"

namespace filasofia::scene {

/// An instrument of a scene: jaws or a scope, alone or in a trocar, or a loop.
struct Instrument {
    BodyId body = {};
    std::shared_ptr<prefab::LaparoscopicInstrument> inTrocar = {}; ///< it owns the jaws
    std::shared_ptr<prefab::Laparoscope> laparoscope = {};
    std::shared_ptr<prefab::ArticulatedInstrument> jaws = {};
    std::shared_ptr<prefab::Endoscope> scope = {};
    std::shared_ptr<prefab::WireLoop> loop = {};
    std::shared_ptr<prefab::SuctionIrrigator> suction = {}; ///< if it is a suction tube
    bool keyed = false;                                     ///< its own keys move it

    [[nodiscard]] bool isScope() const { return scope || laparoscope; }
    [[nodiscard]] BodyId handle() const ///< 0 if it has none
    {
        return inTrocar ? inTrocar->handle() : laparoscope ? laparoscope->handle() : BodyId{};
    }
};
using Instruments = std::vector<Instrument>;

/// Adds a scene's instruments, and their bodies to `ids`; moves them before every step. The first endoscope gives the
/// picture if the scene has no cameras.
Instruments addInstruments(runtime::Simulation& simulation, const SceneDef& scene, std::vector<BodyId>& ids);

/// The body that a haptic interface holds if the scene says that it holds `body`: the handle of what is in a trocar.
BodyId heldFor(const Instruments& instruments, BodyId body);

/// Lets the first button of a haptic interface that holds an instrument close its jaws while it is down; a click closes
/// or opens them. Throws an Error if the interface cannot hold it.
void giveToHand(runtime::Simulation& simulation, const Instruments& instruments, BodyId held, runtime::HapticId hand);

} // namespace filasofia::scene
