#pragma once

#include "filasofia/event/event.h"

#include <array>

namespace filasofia::event {

/// What a person does with a game controller, or with a cap that is pushed and turned in six directions. Merges per
/// kind: the newest wins. Not bound to a window: it comes to the one that has the focus.
class ControllerEvent final : public Event {
public:
    static constexpr EventType kType = EventType::Controller;
    enum class Kind { Gamepad, SpaceMouse };
    ControllerEvent() : Event(kType) {}
    [[nodiscard]] std::optional<MergeKey> mergeKey() const override
    {
        return MergeKey{type, static_cast<std::uint64_t>(kind)};
    }

    Kind kind = Kind::Gamepad;
    std::array<double, 3> push = {};  ///< [-], each in [-1, 1]: to the right, up, towards the person
    std::array<double, 3> twist = {}; ///< [-], each in [-1, 1]: about these axes
    std::uint32_t buttons = 0;        ///< a bit for each that is pressed
};

} // namespace filasofia::event
