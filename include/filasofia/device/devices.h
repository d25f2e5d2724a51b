#pragma once

#include "filasofia/device/motion.h"

#include "filasofia/core/fields.h"

#include <memory>
#include <mutex>
#include <variant>

/// The input and haptic devices that have drivers, and the Defs that select them.
namespace filasofia::device {

/// The mouse with its right button held down, and the keys: the user's input in the window (PointerInput). With Ctrl it
/// turns the hand: sideways, up and down, and with the wheel about the hand's own z axis, the shaft of an instrument.
/// No force.
struct MouseDevice {
    double reach = 2e-4; ///< [m], > 0, displacement of the device per pixel
    double speed = 0.05; ///< [m/s], > 0, while a key is held
    double turn = 5e-3;  ///< [rad], > 0, by which it turns per pixel
};
/// A game controller: the left stick moves sideways and in depth, the right one up and down and around; deflection sets
/// the speed.
struct GamepadDevice {
    double speed = 0.05;    ///< [m/s], > 0, at full deflection of a stick
    double turnSpeed = 1.0; ///< [rad/s], > 0, at full deflection
};
/// A six-axis controller, such as 3Dconnexion's SpaceNavigator.
struct SpaceMouseDevice {
    double speed = 0.1;     ///< [m/s], > 0, at full deflection of the cap
    double turnSpeed = 1.0; ///< [rad/s], > 0, at full deflection
};
/// Plays back a motion: for runs that are reproducible and need no hardware.
struct ScriptedDevice {
    std::variant<std::string, std::shared_ptr<const Motion>> motion = {}; ///< a motion file, or the motion
    bool loop = false;                                                    ///< start again after the end
};
/// An Omega, Delta, Sigma or Falcon, driven through Force Dimension's library libdhd.
struct ForceDimensionDevice {
    int index = 0; ///< [-], in [0, 15], number among the connected devices
};
/// A Touch or Phantom, driven through 3D Systems' library libHD (OpenHapticsDevice).
struct OpenHapticsDevice {
    std::string device = {}; ///< name in its driver's configuration; empty: the default device
};
using DeviceDef =
    std::variant<MouseDevice, GamepadDevice, SpaceMouseDevice, ScriptedDevice, ForceDimensionDevice, OpenHapticsDevice>;

constexpr auto fields(const MouseDevice*)
{
    return describe("MouseDevice",
                    field("reach", &MouseDevice::reach, "m", positive(), "displacement of the device per pixel"),
                    field("speed", &MouseDevice::speed, "m/s", positive(), "speed while a key is held"),
                    field("turn", &MouseDevice::turn, "rad", positive(), "angle per pixel, with Ctrl"));
}
constexpr std::size_t addedFields(const MouseDevice*) { return 1; }
constexpr auto fields(const GamepadDevice*)
{
    return describe(
        "GamepadDevice",
        field("speed", &GamepadDevice::speed, "m/s", positive(), "speed at full deflection of a stick"),
        field("turnSpeed", &GamepadDevice::turnSpeed, "rad/s", positive(), "angular speed at full deflection"));
}
constexpr auto fields(const SpaceMouseDevice*)
{
    return describe(
        "SpaceMouseDevice",
        field("speed", &SpaceMouseDevice::speed, "m/s", positive(), "speed at full deflection of the cap"),
        field("turnSpeed", &SpaceMouseDevice::turnSpeed, "rad/s", positive(), "angular speed at full deflection"));
}
constexpr auto fields(const ScriptedDevice*)
{
    return describe("ScriptedDevice", field("motion", &ScriptedDevice::motion, "a motion file, or the motion"),
                    field("loop", &ScriptedDevice::loop, "start again after the end"));
}
constexpr auto fields(const ForceDimensionDevice*)
{
    return describe("ForceDimensionDevice", field("index", &ForceDimensionDevice::index, "-", closed(0, 15),
                                                  "number among the connected devices"));
}
constexpr auto fields(const OpenHapticsDevice*)
{
    return describe("OpenHapticsDevice", field("device", &OpenHapticsDevice::device,
                                               "name in its driver's configuration; empty: the default device"));
}

/// The names of devices on command lines: "mouse", "gamepad", "spacemouse", "scripted", "forcedimension",
/// "openhaptics".
DeviceDef deviceNamed(const std::string& name); ///< throws an Error that lists all names if it is none of them
std::string nameOf(const DeviceDef& def);

/// The user's input as plain data, to be passed on to a PersonDevice.
struct PersonInput {
    Vec3 moved = {}; ///< [px] mouse displacement to the right, up, towards the user (10 per notch of the wheel)
    /// [px] the same, turning the hand about the device's x and y axes and about its own z axis
    Vec3 turned = {};
    std::optional<Vec3> push = {};             ///< [-], each in [-1, 1]: keys or sticks held, or the cap's displacement
    std::optional<Vec3> twist = {};            ///< [-], each in [-1, 1]: the same for rotation
    std::optional<std::uint32_t> buttons = {}; ///< one bit per pressed button
};

/// A device moved by the user's input: its pose follows the input smoothly, so that it has a velocity.
class PersonDevice final : public HapticDevice {
public:
    /// Metres and radians per pixel, and speeds at full deflection.
    struct Rates {
        double reach = 0.0, turn = 0.0;      ///< [m/px], [rad/px]
        double speed = 0.0, turnSpeed = 0.0; ///< [m/s], [rad/s]
    };
    PersonDevice(std::string name, const Rates& rates);

    void feed(const PersonInput& input); ///< any thread

    [[nodiscard]] std::string name() const override { return name_; }
    void open() override;
    void close() noexcept override {}
    [[nodiscard]] Capabilities capabilities() const override
    {
        return {.orientation = rates_.turnSpeed > 0.0 || rates_.turn > 0.0, .buttons = 32};
    }
    DeviceSample read(double time) noexcept override;
    bool write(const CouplingForce&) noexcept override { return true; }

private:
    const std::string name_;
    const Rates rates_;
    std::mutex mutex_;
    PersonInput input_;          ///< what is held down, and the pixels that are not read yet
    MotionState hand_;           ///< current position, on its way to the target
    Vec3 wanted_;                ///< [m] target position
    Vec3 turnOff_, turning_;     ///< [rad] from the mouse's target, [rad/s] its velocity
    Vec3 twisting_;              ///< [rad/s] velocity of a stick's turn
    std::optional<double> last_; ///< [s]
};

/// Makes the driver. `library` is the path of a vendor's shared library, from a command line or set by the program; if
/// empty, the vendor's default name is used. Throws an Error if the motion file or the library cannot be used.
std::unique_ptr<HapticDevice> makeDevice(const DeviceDef& def, const std::string& library = {});

} // namespace filasofia::device
