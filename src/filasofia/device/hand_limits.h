#pragma once

#include "filasofia/device/haptic_device.h"

namespace filasofia::device {

inline constexpr double kMaxHandDistance = 10.0; ///< [m] from the device's origin: no arm is that long

constexpr double seconds(Nanoseconds time) { return 1e-9 * static_cast<double>(time); }

} // namespace filasofia::device
