#pragma once

#include "filasofia/device/devices.h"
#include "filasofia/event/input_events.h"

#include <set>

namespace filasofia::runtime {

/// Turns mouse and keys of the window into the input of devices that have no driver of their own. The mouse moves the
/// hand while its right button is held; the wheel then moves it towards the screen and back. With Ctrl both turn it.
/// The arrow keys, Page Up and Page Down move it too.
class PersonInputReader {
public:
    /// Nothing if the event is not meant for a device.
    std::optional<device::PersonInput> read(const event::Event& event);

private:
    std::optional<device::PersonInput> readKey(const event::KeyEvent& key);

    bool held_ = false; ///< the right button is pressed
    std::uint32_t buttons_ = 0;
    std::set<event::KeyCode> keys_; ///< now pressed
};

} // namespace filasofia::runtime
