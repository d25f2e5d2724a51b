#pragma once

#include "filasofia/event/event.h"
#include "filasofia/frame/contact.h"

namespace filasofia::runtime {

/// Two bodies touch: at least one of their contacts pushes. A begin and an end for each time that they do, and between
/// them one for every step; of those that wait the newest of a pair is delivered, like a PhysicsUpdateEvent, and before
/// that of its step. Where an event is lost because the queue is full, the next step has StepFlag::EventLost.
class ContactEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Contact;
    enum class Kind {
        Begin,   ///< they touch, and did not in the step before
        Persist, ///< they still touch
        End      ///< they touch no more, or one of them is gone
    };
    ContactEvent() : Event(kType) {}
    [[nodiscard]] std::optional<event::MergeKey> mergeKey() const override;

    Kind kind = Kind::Begin;
    frame::ContactPair pair = {}; ///< the bodies and what they did to each other in the step; zeros at the end
};

} // namespace filasofia::runtime
