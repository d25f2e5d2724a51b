#pragma once

#include "filasofia/math/virtual_coupling.h"

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

/// The seam behind which the driver of an input or haptic device works. A driver uses metres and newtons along the axes
/// of its device, and knows nothing of bodies and scenes.
namespace filasofia::device {

using Nanoseconds = std::int64_t; ///< on a steady clock

enum class DeviceStatus {
    Ready,         ///< the sample is valid
    NotCalibrated, ///< the device must be calibrated first: it is read, but gets no force
    Lost,          ///< the device is gone: unplugged or switched off
    Failed         ///< the device is connected, but its driver reports an error
};

/// The pose and velocity of the hand, in metres along the device's own axes.
struct DeviceSample {
    MotionState hand = {};
    std::uint32_t buttons = 0; ///< one bit per pressed button
    DeviceStatus status = DeviceStatus::Ready;
};

struct Capabilities {
    bool orientation = false; ///< it measures orientation; otherwise the orientation stays the identity
    bool force = false;       ///< it can exert a force
    bool torque = false;      ///< it can exert a torque
    int buttons = 0;          ///< [-], in [0, 32]
    double forceLimit = std::numeric_limits<double>::infinity();  ///< [N], > 0: largest force that it can exert
    double torqueLimit = std::numeric_limits<double>::infinity(); ///< [N m], > 0
};

/// One device. Only one thread at a time calls it. read() and write() neither throw nor wait, as far as the driver's
/// library permits: they are called a thousand times a second.
class HapticDevice {
public:
    virtual ~HapticDevice() = default;
    [[nodiscard]] virtual std::string name() const = 0;
    /// Throws an Error if the device cannot be opened. After close(), or after it was lost, it may be opened again.
    virtual void open() = 0;
    virtual void close() noexcept = 0;                           ///< leaves no force on the hand
    [[nodiscard]] virtual Capabilities capabilities() const = 0; ///< valid while the device is open
    /// `time` [s] is used by devices that play something back, and by those that only measure velocities.
    virtual DeviceSample read(double time) noexcept = 0;
    /// Sets the force on the hand, [N] and [N m] along the device's axes. False if the device refuses it.
    virtual bool write(const CouplingForce& onHand) noexcept = 0;
    /// What is wrong, in a few words, after a status other than Ready or a refused write.
    [[nodiscard]] virtual std::string problem() const { return {}; }
};

/// "ready", "not calibrated", "lost", "failed".
std::string_view describe(DeviceStatus status);

} // namespace filasofia::device
