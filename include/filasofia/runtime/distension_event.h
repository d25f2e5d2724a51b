#pragma once

#include "filasofia/event/event.h"
#include "filasofia/surface/distension_def.h"

namespace filasofia::runtime {

/// What has become of the fluid that distends a cavity: after its first step, once per simulated second while it
/// changes, and as soon as the deficit exceeds its limit. Does not merge. If an event is lost because the queue is
/// full, the next step has StepFlag::EventLost.
class DistensionEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Distension;
    DistensionEvent() : Event(kType) {}

    surface::DistensionBalance balance = {}; ///< since the fluid was added or reset
};

} // namespace filasofia::runtime
