#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/event/event.h"
#include "filasofia/surface/duct_def.h"

namespace filasofia::runtime {

/// What flows in a duct, whenever its state or its number of clips changes, and once per simulated second while it
/// leaks. Does not merge. If an event is lost because the queue is full, the next step has StepFlag::EventLost.
class DuctEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Duct;
    DuctEvent() : Event(kType) {}

    BodyId body = {};
    int duct = 0; ///< [-], index among those of the body
    surface::DuctBalance balance = {};
};

} // namespace filasofia::runtime
