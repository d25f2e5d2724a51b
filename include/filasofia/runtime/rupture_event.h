#pragma once

#include "filasofia/event/event.h"
#include "filasofia/physics/step.h"

namespace filasofia::runtime {

/// A blade cut a body in a step. Does not merge. If an event is lost because the queue is full, the next step has
/// StepFlag::EventLost.
class CutEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Cut;
    CutEvent() : Event(kType) {}

    physics::Rupture rupture = {}; ///< the body, where, how much, and what came loose
};

/// Stress tore a body in a step; otherwise like CutEvent.
class TearEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Tear;
    TearEvent() : Event(kType) {}

    physics::Rupture rupture = {};
};

} // namespace filasofia::runtime
