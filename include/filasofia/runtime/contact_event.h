#pragma once

#include "filasofia/event/event.h"
#include "filasofia/frame/contact.h"

namespace filasofia::runtime {

/// Two bodies touch: at least one of their contacts pushes. There is a begin and an end for each time that they touch,
/// and one event for every step between. If several of these wait, only the newest of a pair is delivered, like a
/// PhysicsUpdateEvent, and before the one of its step. If an event is lost because the queue is full, the next step has
/// StepFlag::EventLost.
class ContactEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Contact;
    enum class Kind {
        Begin,   ///< they touch, and did not in the step before
        Persist, ///< they still touch
        End      ///< they no longer touch, or one of them was removed
    };
    ContactEvent() : Event(kType) {}
    [[nodiscard]] std::optional<event::MergeKey> mergeKey() const override;

    Kind kind = Kind::Begin;
    frame::ContactPair pair = {}; ///< the bodies and the forces between them in the step; zeros at the end
};

} // namespace filasofia::runtime
