#pragma once

#include "filasofia/device/haptic_device.h"

#include "filasofia/core/fields.h"

#include <optional>

/// The force on the hand, from where the device and the body are. Pure arithmetic over the times that it is told: it
/// reads no clock, so that a test can feed it any.
namespace filasofia::device {

struct ServoDef {
    double rate = 1000.0;       ///< [Hz], in [1, 10000], ticks per second
    double scale = 1.0;         ///< [-], in [1e-3, 1e3]: metres of the scene for one of the device
    Pose origin = {};           ///< of the device's axes in the scene
    Quat grip = {};             ///< how the body lies in the hand
    HandCoupling coupling = {}; ///< in the scene
    double forceScale = 1.0;    ///< [-], in [0, 1e3]: newtons on the hand for one in the scene
    double forceLimit = 3.0;    ///< [N], > 0, on the hand
    double torqueLimit = 0.1;   ///< [N m], > 0, on the hand
    double rampIn = 0.3;        ///< [s], >= 0: from nothing to the whole force, after every interruption
    double energyLimit = 0.25;  ///< [J], >= 0: of what the hand has given, so much may be given back later
    double stepPeriod = 1e-3;   ///< [s], > 0: the configured time between two states of the body
};
constexpr auto fields(const ServoDef*)
{
    using T = ServoDef;
    return describe(
        "ServoDef", field("rate", &T::rate, "Hz", closed(1, 10000), "ticks per second"),
        field("scale", &T::scale, "-", closed(1e-3, 1e3), "metres of the scene for one of the device"),
        field("origin", &T::origin, "of the device's axes in the scene"),
        field("grip", &T::grip, "how the body lies in the hand"),
        field("coupling", &T::coupling, "spring and damper, in the scene"),
        field("forceScale", &T::forceScale, "-", closed(0, 1e3), "newtons on the hand for one in the scene"),
        field("forceLimit", &T::forceLimit, "N", positive(), "on the hand"),
        field("torqueLimit", &T::torqueLimit, "N m", positive(), "on the hand"),
        field("rampIn", &T::rampIn, "s", nonNegative(), "from nothing to the whole force"),
        field("energyLimit", &T::energyLimit, "J", nonNegative(), "of what the hand gave, kept for it"),
        field("stepPeriod", &T::stepPeriod, "s", positive(), "between two states of the body"));
}

/// [s] without a new state after which the force is zero: max(50 ms, 3 periods).
constexpr double watchdogOf(double stepPeriod) { return 3.0 * stepPeriod > 0.05 ? 3.0 * stepPeriod : 0.05; }

/// The coupling that the step computes with: its limits are those of the hand, in the scene's newtons, so that body
/// and hand are pulled alike.
HandCoupling sceneCoupling(const ServoDef& def);

/// Where the device's hand is in the scene, turned as the body lies in it.
Moving inScene(const ServoDef& def, const Moving& hand);

/// The body's newest state.
struct BodySample {
    std::uint64_t number = 0; ///< another one for each state
    Nanoseconds time = 0;     ///< at which the body was there
    Moving body = {};         ///< its element's origin
    Vec3 centre = {};         ///< [m] of mass, in the element's coordinates: where the coupling holds it
};

enum class ServoState {
    Waiting,       ///< for the body's first or next state: no force
    Running,       ///< the force is that of the coupling, or on its way there
    NotCalibrated, ///< the device must be calibrated: no force
    Lost,          ///< the device is gone: no force
    Failed,        ///< the device or its driver failed: no force
    Implausible,   ///< the device said what no hand does, or numbers that are none: no force
};
inline constexpr int kServoStates = 6;
std::string_view describe(ServoState state);
/// Nothing is wrong with the device.
constexpr bool isGood(ServoState state) { return state == ServoState::Waiting || state == ServoState::Running; }

struct ServoTick {
    CouplingForce onHand = {}; ///< along the device's axes
    Moving hand = {};          ///< in the scene; the last that was good
    ServoState state = ServoState::Waiting;
    double energy = 0.0; ///< [J] net, that the hand was given since the start
};

class ServoLoop {
public:
    explicit ServoLoop(const ServoDef& def); ///< Error where a field is outside its range

    /// One tick, at times that rise. `body`: the newest state, or nullptr where there is none.
    ServoTick tick(Nanoseconds now, const DeviceSample& device, const BodySample* body);
    /// The force begins anew from nothing: what was done to the hand meanwhile is not known.
    void interrupt();
    /// What the device can do, once it is open.
    void setCapabilities(const Capabilities& capabilities) { capabilities_ = capabilities; }
    [[nodiscard]] const ServoDef& def() const { return def_; }
    void setDef(const ServoDef& def); ///< another place or size of the device in the scene; the force begins anew

private:
    [[nodiscard]] ServoState judge(Nanoseconds now, const DeviceSample& device) const;
    [[nodiscard]] bool fresh(Nanoseconds now, const BodySample* body);
    void countEnergy(const Moving& hand);
    [[nodiscard]] CouplingForce coupled(Nanoseconds now, const Moving& inScene, const BodySample& body) const;
    [[nodiscard]] CouplingForce limited(const CouplingForce& force) const;
    [[nodiscard]] CouplingForce passive(const CouplingForce& force, const Moving& hand) const;

    ServoDef def_;
    Capabilities capabilities_;
    std::optional<Nanoseconds> last_; ///< time of the last tick
    std::optional<Moving> lastHand_;  ///< along the device's axes, while it is good
    Moving lastInScene_;
    CouplingForce given_;                 ///< what the hand has been given since the last tick
    std::optional<Nanoseconds> badUntil_; ///< after something was wrong: until it has been right for a while
    std::optional<std::uint64_t> number_; ///< of the newest state
    Nanoseconds newest_ = 0;              ///< when that came
    double ramp_ = 0.0;                   ///< [-], in [0, 1]
    double energy_ = 0.0;                 ///< [J] given to the hand
    double stored_ = 0.0;                 ///< [J] that it may have back
    ServoState bad_ = ServoState::Failed; ///< what was wrong
};

} // namespace filasofia::device
