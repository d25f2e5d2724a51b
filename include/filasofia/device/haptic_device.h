#pragma once

#include "filasofia/math/hand_coupling.h"

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

/// What a hand holds: the seam behind which a device's driver works. A driver knows metres and newtons along the axes
/// of its device, and nothing of bodies and scenes.
namespace filasofia::device {

using Nanoseconds = std::int64_t; ///< on a steady clock

enum class DeviceStatus {
    Ready,         ///< the sample says where the hand is
    NotCalibrated, ///< the device must be calibrated first: it is read, and gets no force
    Lost,          ///< it is gone: unplugged, switched off
    Failed         ///< it is there and its driver reports an error
};

/// Where the hand is, in metres along the device's own axes.
struct DeviceSample {
    Moving hand = {};
    std::uint32_t buttons = 0; ///< a bit for each that is pressed
    DeviceStatus status = DeviceStatus::Ready;
};

struct Capabilities {
    bool orientation = false; ///< it measures how the hand turns; else the orientation stays the identity
    bool force = false;       ///< it pushes the hand
    bool torque = false;      ///< it turns the hand
    int buttons = 0;          ///< [-], in [0, 32]
    double forceLimit = std::numeric_limits<double>::infinity();  ///< [N], > 0: what it can push with
    double torqueLimit = std::numeric_limits<double>::infinity(); ///< [N m], > 0
};

/// One device. All calls come from one thread at a time. read() and write() neither throw nor wait, as far as the
/// driver's library lets them: they are called a thousand times a second.
class HapticDevice {
public:
    virtual ~HapticDevice() = default;
    [[nodiscard]] virtual std::string name() const = 0;
    /// Throws an Error where there is none. After close(), or when it was lost, it may be opened again.
    virtual void open() = 0;
    virtual void close() noexcept = 0;                           ///< no force is left on the hand
    [[nodiscard]] virtual Capabilities capabilities() const = 0; ///< of one that is open
    /// `time` [s] is for devices that play something back, and for those that only know velocities.
    virtual DeviceSample read(double time) noexcept = 0;
    /// On the hand: [N], [N m], along the device's axes. False: the device refuses it.
    virtual bool write(const CouplingForce& onHand) noexcept = 0;
    /// What is wrong, in a few words, after a status other than Ready or a write that was refused.
    [[nodiscard]] virtual std::string problem() const { return {}; }
};

/// "ready", "not calibrated", "lost", "failed".
std::string_view describe(DeviceStatus status);

} // namespace filasofia::device
