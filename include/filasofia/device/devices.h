#pragma once

#include "filasofia/device/motion.h"

#include "filasofia/core/fields.h"

#include <memory>
#include <mutex>
#include <variant>

/// The devices that there are drivers for, and how one is asked for.
namespace filasofia::device {

/// The mouse with its right button held, and the keys: what a person does in the window (PointerInput). No force.
struct MouseDevice {
    double reach = 2e-4; ///< [m], > 0, of the device for a pixel
    double speed = 0.05; ///< [m/s], > 0, while a key is held
};
/// A game controller: the left stick to the sides and into depth, the right one up and down and round, by its speed.
struct GamepadDevice {
    double speed = 0.05;    ///< [m/s], > 0, of a stick held to its end
    double turnSpeed = 1.0; ///< [rad/s], > 0
};
/// A cap that is pushed and turned in six directions, such as 3Dconnexion's SpaceNavigator.
struct SpaceMouseDevice {
    double speed = 0.1;     ///< [m/s], > 0, of the cap pushed to its end
    double turnSpeed = 1.0; ///< [rad/s], > 0
};
/// Plays a motion back: for runs that come out the same every time, and without hardware.
struct ScriptedDevice {
    std::variant<std::string, std::shared_ptr<const Motion>> motion = {}; ///< a motion file, or the motion
    bool loop = false;                                                    ///< at its end it begins anew
};
/// An Omega, Delta, Sigma or Falcon, by Force Dimension's library libdhd.
struct ForceDimensionDevice {
    int index = 0; ///< [-], in [0, 15], among those connected
};
/// A Touch or Phantom, by 3D Systems' library libHD (OpenHapticsDevice).
struct OpenHapticsDevice {
    std::string device = {}; ///< as its driver's configuration names it; empty: the default device
};
using DeviceDef =
    std::variant<MouseDevice, GamepadDevice, SpaceMouseDevice, ScriptedDevice, ForceDimensionDevice, OpenHapticsDevice>;

constexpr auto fields(const MouseDevice*)
{
    return describe("MouseDevice", field("reach", &MouseDevice::reach, "m", positive(), "of the device for a pixel"),
                    field("speed", &MouseDevice::speed, "m/s", positive(), "while a key is held"));
}
constexpr auto fields(const GamepadDevice*)
{
    return describe("GamepadDevice",
                    field("speed", &GamepadDevice::speed, "m/s", positive(), "of a stick held to its end"),
                    field("turnSpeed", &GamepadDevice::turnSpeed, "rad/s", positive(), "the same of its turning"));
}
constexpr auto fields(const SpaceMouseDevice*)
{
    return describe("SpaceMouseDevice",
                    field("speed", &SpaceMouseDevice::speed, "m/s", positive(), "of the cap at its end"),
                    field("turnSpeed", &SpaceMouseDevice::turnSpeed, "rad/s", positive(), "the same of its turning"));
}
constexpr auto fields(const ScriptedDevice*)
{
    return describe("ScriptedDevice", field("motion", &ScriptedDevice::motion, "a motion file, or the motion"),
                    field("loop", &ScriptedDevice::loop, "at its end it begins anew"));
}
constexpr auto fields(const ForceDimensionDevice*)
{
    return describe("ForceDimensionDevice",
                    field("index", &ForceDimensionDevice::index, "-", closed(0, 15), "among those connected"));
}
constexpr auto fields(const OpenHapticsDevice*)
{
    return describe("OpenHapticsDevice", field("device", &OpenHapticsDevice::device, "as its driver names it"));
}

/// The words by which command lines name devices: "mouse", "gamepad", "spacemouse", "scripted", "forcedimension",
/// "openhaptics".
DeviceDef deviceNamed(const std::string& name); ///< Error naming them all where it is none of them
std::string nameOf(const DeviceDef& def);

/// What a person does, as plain data; whoever gets a person's input hands it on.
struct PersonInput {
    Vec3 moved = {}; ///< [px] by the mouse: to the right, up, towards the person (10 per notch of the wheel)
    std::optional<Vec3> push = {};             ///< [-], each in [-1, 1]: keys or sticks held, or the cap's place
    std::optional<Vec3> twist = {};            ///< [-], each in [-1, 1]: the same of turning
    std::optional<std::uint32_t> buttons = {}; ///< a bit for each that is pressed
};

/// A device that is moved by a person's input: a place that follows it smoothly, so that it has a velocity.
class PersonDevice final : public HapticDevice {
public:
    PersonDevice(std::string name, double reach, double speed, double turnSpeed);

    void feed(const PersonInput& input); ///< any thread

    [[nodiscard]] std::string name() const override { return name_; }
    void open() override;
    void close() noexcept override {}
    [[nodiscard]] Capabilities capabilities() const override
    {
        return {.orientation = turnSpeed_ > 0.0, .buttons = 32};
    }
    DeviceSample read(double time) noexcept override;
    bool write(const CouplingForce&) noexcept override { return true; }

private:
    const std::string name_;
    const double reach_, speed_, turnSpeed_;
    std::mutex mutex_;
    PersonInput input_;          ///< what is held, and the pixels not read yet
    Moving hand_;                ///< where it is, on its way
    Vec3 wanted_;                ///< [m] where it is going
    std::optional<double> last_; ///< [s]
};

/// Makes the driver. `library`: the path of a vendor's shared library, from a command line or a program's own words;
/// empty: the vendor's name for it. Throws an Error where the motion file or the library cannot be used.
std::unique_ptr<HapticDevice> makeDevice(const DeviceDef& def, const std::string& library = {});

} // namespace filasofia::device
