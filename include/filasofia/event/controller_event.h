#pragma once

#include "filasofia/event/event.h"

#include <array>

namespace filasofia::event {

/// The state of a game controller, or of a six-axis controller (a cap that is pushed and turned). Merges per kind: the
/// newest wins. It is not bound to a window: the window with the focus gets it.
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
    std::array<double, 3> push = {};  ///< [-], each in [-1, 1]: to the right, up, towards the user
    std::array<double, 3> twist = {}; ///< [-], each in [-1, 1]: about these axes
    std::uint32_t buttons = 0;        ///< one bit per pressed button
};

} // namespace filasofia::event
