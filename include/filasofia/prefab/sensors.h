#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/runtime/simulation.h"

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace filasofia::prefab {

// What a sensor reads. A body that was removed, and all that is not known, reads as NaN.

/// x, y, z [m], in the world. Nodes of a piece that was removed stay where they were, also in the mean.
struct PositionSensor {
    BodyId body = {};
    int element = 0;              ///< [-], >= 0, index in a rigid body
    Vec3 tip = {};                ///< [m], the point, in the element's coordinates
    std::optional<int> node = {}; ///< [-], >= 0, of a soft body or a rod; not given: the mean of its nodes
};
/// x, y, z [m/s], in the world: of the centre of mass of a dynamic element, of the origin of a link or of a kinematic
/// element.
struct VelocitySensor {
    BodyId body = {};
    int element = 0;              ///< [-], >= 0, index in a rigid body
    std::optional<int> node = {}; ///< [-], >= 0, of a soft body or a rod; not given: the mean of its nodes
};
/// x, y, z [N], the force of contacts with other bodies on this one; and the sum of their normal forces [N].
struct ContactForceSensor {
    BodyId body = {}; ///< one that collides
    BodyId with = {}; ///< another one that collides; none: with all others
};
/// x, y, z [N], the force of attachments and grasps on a body.
struct AttachmentForceSensor {
    BodyId body = {};
    BodyId to = {};     ///< none: of all, also of those to space
    bool space = false; ///< of those to space only: what a clamp bears. Then there is no `to`
};
/// Position and velocity [rad, rad/s or m, m/s], and the forces of its drive and of the load [N m or N]: frame::Joint.
struct JointSensor {
    BodyId body = {};
    int joint = 0; ///< [-], >= 0, index in the body's articulation
};
/// Volume [m^3], pressure [Pa], outflow [m^3/s], and what has flowed out [m^3]: frame::Cavity.
struct CavitySensor {
    BodyId body = {};
    int cavity = 0; ///< [-], >= 0, index in SoftBodyDef::cavities
};
/// Flow and leak [m^3/s], what has leaked [m^3], how open it is where it is narrowest [-]: surface::DuctBalance.
struct DuctSensor {
    BodyId body = {};
    int duct = 0; ///< [-], >= 0, index among those of the body
};
/// What has welled, what is on the tissue [m^3], and what wells now [m^3/s]: surface::BloodBalance.
struct BloodSensor {
    BodyId body = {}; ///< a body that bleeds
};
/// The highest temperature now [K], burnt and charred area [m^2], and the heat taken [J]: surface::HeatBalance.
struct HeatSensor {
    BodyId body = {}; ///< a body that burns
};
/// How long its pedal was pressed, and how long in air [s]; what tissue has taken [J]: surface::EnergyBalance.
struct ElectrodeSensor {
    BodyId body = {};
    int electrode = 0; ///< [-], >= 0, index among those of the body
};
/// Kinetic, elastic and gravitational energy [J]: physics::MechanicalEnergy. About 1 us per element and reading.
struct EnergySensor {
    BodyId body = {};
};
/// The fluid that distends a cavity: pressure [Pa], volume, deficit and blood [m^3]: surface::DistensionBalance.
struct FluidSensor {};

using SensorKind =
    std::variant<PositionSensor, VelocitySensor, ContactForceSensor, AttachmentForceSensor, JointSensor, CavitySensor,
                 DuctSensor, BloodSensor, HeatSensor, ElectrodeSensor, EnergySensor, FluidSensor>;

constexpr auto fields(const PositionSensor*)
{
    using T = PositionSensor;
    return describe("PositionSensor", field("body", &T::body, "the body"),
                    field("element", &T::element, "-", nonNegative(), "index in a rigid body"),
                    field("tip", &T::tip, "m", finite(), "the point, in the element's coordinates"),
                    field("node", &T::node, "-", nonNegative(), "of a soft body or a rod; without it the mean of all"));
}
constexpr auto fields(const VelocitySensor*)
{
    using T = VelocitySensor;
    return describe("VelocitySensor", field("body", &T::body, "the body"),
                    field("element", &T::element, "-", nonNegative(), "index in a rigid body"),
                    field("node", &T::node, "-", nonNegative(), "of a soft body or a rod; without it the mean of all"));
}
constexpr auto fields(const ContactForceSensor*)
{
    using T = ContactForceSensor;
    return describe("ContactForceSensor", field("body", &T::body, "the body on which the force acts"),
                    field("with", &T::with, "the other one; none: all others"));
}
constexpr auto fields(const AttachmentForceSensor*)
{
    using T = AttachmentForceSensor;
    return describe("AttachmentForceSensor", field("body", &T::body, "the body on which the force acts"),
                    field("to", &T::to, "the other one; none: all others and space"),
                    field("space", &T::space, "only attachments to space: what a clamp bears"));
}
constexpr auto fields(const JointSensor*)
{
    using T = JointSensor;
    return describe("JointSensor", field("body", &T::body, "the articulated body"),
                    field("joint", &T::joint, "-", nonNegative(), "index in the body's articulation"));
}
constexpr auto fields(const CavitySensor*)
{
    using T = CavitySensor;
    return describe("CavitySensor", field("body", &T::body, "the soft body"),
                    field("cavity", &T::cavity, "-", nonNegative(), "index among those of the body"));
}
constexpr auto fields(const DuctSensor*)
{
    using T = DuctSensor;
    return describe("DuctSensor", field("body", &T::body, "the soft body"),
                    field("duct", &T::duct, "-", nonNegative(), "index among those of the body"));
}
constexpr auto fields(const BloodSensor*)
{
    return describe("BloodSensor", field("body", &BloodSensor::body, "a body that bleeds"));
}
constexpr auto fields(const HeatSensor*)
{
    return describe("HeatSensor", field("body", &HeatSensor::body, "a body that burns"));
}
constexpr auto fields(const ElectrodeSensor*)
{
    using T = ElectrodeSensor;
    return describe("ElectrodeSensor", field("body", &T::body, "the rigid body"),
                    field("electrode", &T::electrode, "-", nonNegative(), "index among those of the body"));
}
constexpr auto fields(const EnergySensor*)
{
    return describe("EnergySensor", field("body", &EnergySensor::body, "the body"));
}
constexpr auto fields(const FluidSensor*) { return describe("FluidSensor"); }

/// A sensor. In a file, the fields of its kind stand beside the name.
struct SensorDef {
    /// The only one of this name, which can be read in a line; empty: "sensor 1" and so on, by its place in the list.
    std::string name = {};
    SensorKind kind = PositionSensor{};
};
constexpr auto fields(const SensorDef*)
{
    return describe("SensorDef", field("", &SensorDef::kind, "what it reads, whose fields stand beside the name"),
                    field("name", &SensorDef::name, "what its columns are called"));
}

struct SensorsDef {
    std::vector<SensorDef> sensors = {}; ///< at least one, at most 1000
    double rate = 100.0;   ///< [Hz], in [0.001, 100000], lines per second of simulated time; at most one per step
    std::string file = {}; ///< a .csv file; empty: none
};
constexpr auto fields(const SensorsDef*)
{
    using T = SensorsDef;
    return describe("SensorsDef", field("sensors", &T::sensors, "what is read"),
                    field("rate", &T::rate, "Hz", closed(1e-3, 1e5), "lines per second"),
                    field("file", &T::file, "a .csv file"));
}

/// What a sensor reads in a state.
struct SensorReading {
    std::string name = {};
    std::vector<std::string> columns = {}; ///< "x [m]", "y [m]", "z [m]"
    std::vector<double> values = {};       ///< one per column; NaN: not known
};

/// Reads a simulation over time into a table: a line at the first state, and then at the first one of each period of
/// the rate. In a cell, NaN is empty.
///
/// The states are read on the stepping thread, and written by a thread of its own; only if 16 MB wait for the disk does
/// the stepping thread write them. If writing fails, that is one line in the log and a FileFailedEvent, and the
/// simulation goes on. While physics is paused nothing is
/// read. With a file, a saved state cannot be restored (Error): in a table, time only goes on.
class Sensors {
public:
    /// Construct it after all that it reads and before a run, and destroy it before the simulation. Throws an Error
    /// naming the sensor and the field if there is nothing to read, or the file cannot be written.
    Sensors(runtime::Simulation& simulation, SensorsDef def);
    ~Sensors(); ///< calls close()
    Sensors(const Sensors&) = delete;
    Sensors& operator=(const Sensors&) = delete;

    /// What they read in the newest state; NaN before the first step. On the stepping thread, or while no step is
    /// computed.
    [[nodiscard]] std::vector<SensorReading> read() const;
    /// Reads the last state, if a line is due, and writes all that waits. Not from inside the simulation's callbacks.
    void close();
    [[nodiscard]] std::uint64_t lines() const; ///< [-], of numbers that were written
    [[nodiscard]] bool failed() const;         ///< writing ended early

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callbacks, which may outlive this
};

} // namespace filasofia::prefab
