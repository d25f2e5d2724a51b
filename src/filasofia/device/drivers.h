#pragma once

#include "filasofia/device/devices.h"

/// One factory function per driver; makeDevice() chooses.
namespace filasofia::device {

std::unique_ptr<HapticDevice> makeScripted(const ScriptedDevice& def);
std::unique_ptr<HapticDevice> makeForceDimension(const ForceDimensionDevice& def, const std::string& library);
std::unique_ptr<HapticDevice> makeOpenHaptics(const OpenHapticsDevice& def, const std::string& library);

} // namespace filasofia::device
