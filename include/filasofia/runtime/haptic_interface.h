#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/device/devices.h"
#include "filasofia/device/haptic_servo.h"

#include <compare>
#include <optional>

namespace filasofia::runtime {

/// A device in a hand, and the rigid element that it controls. A dynamic body is pulled along by the coupling, and the
/// hand feels what holds it back. A body that goes where it is told goes where the hand is, and the hand feels nothing.
struct HapticInterfaceDef {
    std::string name = "haptic interface";
    device::DeviceDef device = device::MouseDevice{};
    double scale = 1.0; ///< [-], in [1e-3, 1e3]: metres of the scene for one of the device
    /// Of the device's axes in the scene: the body is where the hand is. Not given: its axes are the scene's, and where
    /// the hand is at first, the body is as it was added.
    std::optional<Pose> origin = {};
    BodyId body = {};              ///< a rigid body
    int element = 0;               ///< [-], >= 0, of it
    VirtualCoupling coupling = {}; ///< in the scene
    double forceScale = 1.0;       ///< [-], in [0, 1e3]: newtons on the hand for one in the scene
    double forceLimit = 3.0;   ///< [N], > 0, on the hand, and by force scale on the body; the device's own holds too
    double torqueLimit = 0.1;  ///< [N m], > 0, the same of its turning
    double rampIn = 0.3;       ///< [s], >= 0: from nothing to the whole force, after every interruption
    double energyLimit = 0.25; ///< [J], >= 0: of what the hand has given, so much may be given back later
    double rate = 1000.0;      ///< [Hz], in [100, 10000], of the servo loop in a live run
};
constexpr auto fields(const HapticInterfaceDef*)
{
    using T = HapticInterfaceDef;
    return describe(
        "HapticInterfaceDef", field("name", &T::name, "what errors and the log call it"),
        field("device", &T::device, "what the hand holds"),
        field("scale", &T::scale, "-", closed(1e-3, 1e3), "metres of the scene for one of the device"),
        field("origin", &T::origin, "of the device's axes in the scene"), field("body", &T::body, "a rigid body"),
        field("element", &T::element, "-", nonNegative(), "of the body"),
        field("coupling", &T::coupling, "spring and damper, in the scene"),
        field("forceScale", &T::forceScale, "-", closed(0, 1e3), "newtons on the hand for one in the scene"),
        field("forceLimit", &T::forceLimit, "N", positive(), "on the hand"),
        field("torqueLimit", &T::torqueLimit, "N m", positive(), "on the hand"),
        field("rampIn", &T::rampIn, "s", nonNegative(), "from nothing to the whole force"),
        field("energyLimit", &T::energyLimit, "J", nonNegative(), "of what the hand gave, kept for it"),
        field("rate", &T::rate, "Hz", closed(100, 10000), "of the servo loop in a live run"));
}

/// Names a haptic interface. Numbers are given once; 0 names nothing.
struct HapticId {
    std::uint32_t value = 0;

    constexpr explicit operator bool() const { return value != 0; }
    friend constexpr auto operator<=>(HapticId, HapticId) = default;
};

/// How a haptic interface is doing, all in the scene's axes.
struct HapticState {
    device::ServoState state = device::ServoState::Waiting;
    MotionState hand = {};     ///< the last that was good
    std::uint32_t buttons = 0; ///< a bit for each that is pressed
    CouplingForce onHand = {}; ///< [N], [N m], as the device was told last
    CouplingForce onBody = {}; ///< [N] at its centre of mass, [N m]: the coupling's at the end of the last step
    device::ServoStatistics servo = {};
};

} // namespace filasofia::runtime
