#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/event/event.h"
#include "filasofia/surface/bleeding_def.h"

namespace filasofia::runtime {

/// How much blood a body has lost: once when its blood is first known, and then once per simulated second while it
/// changes. Does not merge. If an event is lost because the queue is full, the next step has StepFlag::EventLost.
class BleedingEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Bleeding;
    BleedingEvent() : Event(kType) {}

    BodyId body = {};
    surface::BloodBalance balance = {}; ///< since the body was added or reset
};

} // namespace filasofia::runtime
