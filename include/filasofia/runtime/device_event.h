#pragma once

#include "filasofia/event/event.h"
#include "filasofia/runtime/haptic_interface.h"

namespace filasofia::runtime {

/// Something happened to the device of a haptic interface. Does not merge.
class DeviceEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::Device;
    DeviceEvent() : Event(kType) {}

    HapticId interface = {};
    device::DeviceNotice notice = {}; ///< connected, lost, an error with its description, or a button
};

} // namespace filasofia::runtime
