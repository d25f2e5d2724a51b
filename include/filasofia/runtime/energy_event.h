#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/event/event.h"
#include "filasofia/surface/electrode_def.h"

namespace filasofia::runtime {

/// What an electrode has done: once after the first step, whenever its pedal is pressed or released, and once per
/// simulated second while it is active. Does not merge. If an event is lost because the queue is full, the next step
/// has StepFlag::EventLost.
class EnergyEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Energy;
    EnergyEvent() : Event(kType) {}

    BodyId body = {};
    int electrode = 0;   ///< [-], index among those of the body
    bool active = false; ///< its pedal is pressed
    surface::EnergyBalance balance = {};
};

} // namespace filasofia::runtime
