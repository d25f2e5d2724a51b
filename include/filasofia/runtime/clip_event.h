#pragma once

#include "filasofia/event/event.h"
#include "filasofia/physics/step.h"

namespace filasofia::runtime {

/// A clip began to close on tissue, was closed on nothing, or slipped off. Does not merge. If an event is lost because
/// the queue is full, the next step has StepFlag::EventLost.
class ClipEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Clip;
    ClipEvent() : Event(kType) {}

    physics::ClipChange change = {};
};

} // namespace filasofia::runtime
