#pragma once

#include "filasofia/event/event.h"
#include "filasofia/physics/step.h"

namespace filasofia::runtime {

/// Points of an attachment or a grasp let go in a step. Does not merge. If an event is lost because the queue is full,
/// the next step has StepFlag::EventLost.
class BreakEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Break;
    BreakEvent() : Event(kType) {}

    physics::AttachmentBreak attachment = {};
};

} // namespace filasofia::runtime
