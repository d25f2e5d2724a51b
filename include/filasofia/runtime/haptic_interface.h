#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/device/devices.h"
#include "filasofia/device/haptic_servo.h"

#include <compare>
#include <optional>

namespace filasofia::runtime {

/// A haptic device, and the rigid element that it controls. A dynamic body is pulled along by the virtual coupling, and
/// the hand feels what holds it back. A kinematic body goes where the hand is, and the hand feels nothing. Without a
/// body, Simulation::haptic() tells where the hand is and what it presses, for code of the user's own.
struct HapticInterfaceDef {
    std::string name = "haptic interface";
    device::DeviceDef device = device::MouseDevice{};
    double scale = 1.0; ///< [-], in [1e-3, 1e3], metres in the scene per metre of the device
    /// Pose of the device's axes in the scene; the body is where the hand is. If it is not given, the axes are the
    /// scene's, and the hand's first place is where the body was added (without a body: where the device says).
    std::optional<Pose> origin = {};
    BodyId body = {}; ///< a rigid body, without joints if it is dynamic; none: the hand moves and feels nothing
    int element = 0;  ///< [-], >= 0, index in the body; 0 without a body, and if it has joints
    VirtualCoupling coupling = {}; ///< in the scene
    double forceScale = 1.0;       ///< [-], in [0, 1e3], newtons on the hand per newton in the scene
    /// [N], > 0, on the hand; divided by the force scale, on the body; the device's own limit holds too
    double forceLimit = 3.0;
    double torqueLimit = 0.1;  ///< [N m], > 0, the same for torques
    double rampIn = 0.3;       ///< [s], >= 0, time from no force to the full force, after every interruption
    double energyLimit = 0.25; ///< [J], >= 0, how much of the energy that the hand has put in may be returned later
    double rate = 1000.0;      ///< [Hz], in [100, 10000], rate of the servo loop in a live run
};
constexpr auto fields(const HapticInterfaceDef*)
{
    using T = HapticInterfaceDef;
    return describe(
        "HapticInterfaceDef", field("name", &T::name, "what errors and the log call it"),
        field("device", &T::device, "what the hand holds"),
        field("scale", &T::scale, "-", closed(1e-3, 1e3), "metres in the scene per metre of the device"),
        field("origin", &T::origin, "pose of the device's axes in the scene"),
        field("body", &T::body, "a rigid body; none: the hand moves nothing"),
        field("element", &T::element, "-", nonNegative(), "index in the body"),
        field("coupling", &T::coupling, "spring and damper, in the scene"),
        field("forceScale", &T::forceScale, "-", closed(0, 1e3), "newtons on the hand per newton in the scene"),
        field("forceLimit", &T::forceLimit, "N", positive(), "limit on the hand"),
        field("torqueLimit", &T::torqueLimit, "N m", positive(), "limit on the hand"),
        field("rampIn", &T::rampIn, "s", nonNegative(), "time from no force to the full force"),
        field("energyLimit", &T::energyLimit, "J", nonNegative(), "energy that may be returned to the hand"),
        field("rate", &T::rate, "Hz", closed(100, 10000), "rate of the servo loop in a live run"));
}

/// Names a haptic interface. Numbers are given once; 0 names nothing.
struct HapticId {
    std::uint32_t value = 0;

    constexpr explicit operator bool() const { return value != 0; }
    friend constexpr auto operator<=>(HapticId, HapticId) = default;
};

/// The state of a haptic interface, all in the scene's axes.
struct HapticState {
    device::ServoState state = device::ServoState::Waiting;
    MotionState hand = {};     ///< the last valid one
    std::uint32_t buttons = 0; ///< one bit for each pressed button
    CouplingForce onHand = {}; ///< [N], [N m], last sent to the device
    CouplingForce onBody = {}; ///< [N] at its centre of mass, [N m]: the coupling's force at the end of the last step
    device::ServoStatistics servo = {};
};

} // namespace filasofia::runtime
