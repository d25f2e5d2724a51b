#pragma once

#include "filasofia/event/event.h"
#include "filasofia/physics/step.h"

namespace filasofia::runtime {

/// Surfaces of two bodies begin or cease to pass through each other (StepReport::intersections). Does not merge. If an
/// event is lost because the queue is full, the next step has StepFlag::EventLost.
class IntersectionEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Intersection;
    enum class Kind {
        Begin, ///< they pass through each other, and did not at the last test
        End    ///< they no longer do, or one of them was removed
    };
    IntersectionEvent() : Event(kType) {}

    Kind kind = Kind::Begin;
    physics::Intersection intersection = {}; ///< at the end: as it was last
};

} // namespace filasofia::runtime
