#pragma once

#include "filasofia/device/haptic_device.h"

#include "filasofia/core/fields.h"

#include <optional>

/// The force on the hand, computed from the motion of device and body. Pure arithmetic over the times that it gets: it
/// reads no clock, so a test can pass any times.
namespace filasofia::device {

struct ServoDef {
    double rate = 1000.0;          ///< [Hz], in [1, 10000], ticks per second
    double scale = 1.0;            ///< [-], in [1e-3, 1e3]: metres of the scene per metre of the device
    Pose origin = {};              ///< pose of the device's axes in the scene
    Quat grip = {};                ///< orientation of the body in the hand
    VirtualCoupling coupling = {}; ///< the virtual coupling, in the scene's units
    double forceScale = 1.0;       ///< [-], in [0, 1e3]: newtons on the hand per newton in the scene
    double forceLimit = 3.0;       ///< [N], > 0, largest force on the hand
    double torqueLimit = 0.1;      ///< [N m], > 0, largest torque on the hand
    double rampIn =
        0.3; ///< [s], >= 0: time in which the force rises from zero to its full value after every interruption
    double energyLimit =
        0.25; ///< [J], >= 0: how much of the energy that the hand has put in may be returned to it later
    double stepPeriod = 1e-3; ///< [s], > 0: the configured time between two states of the body
};
constexpr auto fields(const ServoDef*)
{
    using T = ServoDef;
    return describe(
        "ServoDef", field("rate", &T::rate, "Hz", closed(1, 10000), "ticks per second"),
        field("scale", &T::scale, "-", closed(1e-3, 1e3), "metres of the scene per metre of the device"),
        field("origin", &T::origin, "pose of the device's axes in the scene"),
        field("grip", &T::grip, "orientation of the body in the hand"),
        field("coupling", &T::coupling, "the virtual coupling (spring and damper), in the scene's units"),
        field("forceScale", &T::forceScale, "-", closed(0, 1e3), "newtons on the hand per newton in the scene"),
        field("forceLimit", &T::forceLimit, "N", positive(), "largest force on the hand"),
        field("torqueLimit", &T::torqueLimit, "N m", positive(), "largest torque on the hand"),
        field("rampIn", &T::rampIn, "s", nonNegative(),
              "time in which the force rises to its full value after an interruption"),
        field("energyLimit", &T::energyLimit, "J", nonNegative(),
              "energy of the hand that may be returned to it later"),
        field("stepPeriod", &T::stepPeriod, "s", positive(), "configured time between two states of the body"));
}

/// [s] The force becomes zero if no new state arrives for this long: max(50 ms, 3 periods).
constexpr double watchdogOf(double stepPeriod) { return 3.0 * stepPeriod > 0.05 ? 3.0 * stepPeriod : 0.05; }

/// The coupling for the physics step. Its limits are those of the hand in the scene's newtons, so that body and hand
/// get the same force.
VirtualCoupling sceneCoupling(const ServoDef& def);

/// The motion of the device's hand in the scene, with the orientation of the body in the hand.
MotionState inScene(const ServoDef& def, const MotionState& hand);

/// The body's newest state.
struct BodySample {
    std::uint64_t number = 0; ///< differs for each state
    Nanoseconds time = 0;     ///< when the body was in this state
    MotionState body = {};    ///< motion of its element's origin
    Vec3 centre = {};         ///< [m] centre of mass in the element's coordinates, where the coupling acts
};

enum class ServoState {
    Waiting,       ///< waiting for the body's first or next state: no force
    Running,       ///< the force is that of the coupling, or is rising to it
    NotCalibrated, ///< the device must be calibrated: no force
    Lost,          ///< the device is gone: no force
    Failed,        ///< the device or its driver failed: no force
    Implausible,   ///< the device reported an impossible motion or non-finite numbers: no force
};
inline constexpr int kServoStates = 6;
std::string_view describe(ServoState state);
/// True if nothing is wrong with the device.
constexpr bool isGood(ServoState state) { return state == ServoState::Waiting || state == ServoState::Running; }

struct ServoTick {
    CouplingForce onHand = {}; ///< along the device's axes
    MotionState hand = {};     ///< in the scene; the last valid one
    ServoState state = ServoState::Waiting;
    double energy = 0.0; ///< [J] net energy given to the hand since the start
};

class ServoLoop {
public:
    explicit ServoLoop(const ServoDef& def); ///< throws an Error if a field is outside its range

    /// Computes one tick; times must increase. `body` is the newest state, or nullptr if there is none.
    ServoTick tick(Nanoseconds now, const DeviceSample& device, const BodySample* body);
    /// Lets the force rise from zero again, because what happened to the hand meanwhile is unknown.
    void interrupt();
    /// Sets the device's capabilities, once it is open.
    void setCapabilities(const Capabilities& capabilities) { capabilities_ = capabilities; }
    [[nodiscard]] const ServoDef& def() const { return def_; }
    void setDef(
        const ServoDef& def); ///< changes the device's placement or scale in the scene; the force rises from zero again

private:
    [[nodiscard]] ServoState judge(Nanoseconds now, const DeviceSample& device) const;
    [[nodiscard]] bool fresh(Nanoseconds now, const BodySample* body);
    void countEnergy(const MotionState& hand);
    [[nodiscard]] CouplingForce coupled(Nanoseconds now, const MotionState& inScene, const BodySample& body) const;
    [[nodiscard]] CouplingForce limited(const CouplingForce& force) const;
    [[nodiscard]] CouplingForce passive(const CouplingForce& force, const MotionState& hand) const;

    ServoDef def_;
    Capabilities capabilities_;
    std::optional<Nanoseconds> last_;     ///< time of the last tick
    std::optional<MotionState> lastHand_; ///< along the device's axes, while it is valid
    MotionState lastInScene_;
    CouplingForce given_;                 ///< force given to the hand since the last tick
    std::optional<Nanoseconds> badUntil_; ///< end of the settling time after a fault
    std::optional<std::uint64_t> number_; ///< number of the newest state
    Nanoseconds newest_ = 0;              ///< when that state arrived
    double ramp_ = 0.0;                   ///< [-], in [0, 1]
    double energy_ = 0.0;                 ///< [J] given to the hand
    double stored_ = 0.0;                 ///< [J] that may be returned to the hand
    ServoState bad_ = ServoState::Failed; ///< what was wrong
};

} // namespace filasofia::device
