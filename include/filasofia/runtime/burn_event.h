#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/event/event.h"
#include "filasofia/surface/burning_def.h"

namespace filasofia::runtime {

/// How much of a body is burnt: once when its heat is first known, and then once per simulated second while the burnt
/// area changes. Does not merge. If an event is lost because the queue is full, the next step has StepFlag::EventLost.
class BurnEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Burn;
    BurnEvent() : Event(kType) {}

    BodyId body = {};
    bool target = true;                ///< BurningDef::target
    bool injury = false;               ///< it is burnt, and is no target (BurningDef::target)
    surface::HeatBalance balance = {}; ///< since the body was added or reset
};

} // namespace filasofia::runtime
