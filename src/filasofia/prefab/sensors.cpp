#include "filasofia/prefab/sensors.h"

#include "filasofia/core/check_name.h"
#include "filasofia/core/guarded_call.h"
#include "filasofia/core/log.h"
#include "filasofia/core/output_file.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/core/word.h"
#include "filasofia/metric/csv.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/prefab/body_points.h"
#include "filasofia/prefab/file_failure.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <set>
#include <thread>
#include <utility>

namespace filasofia::prefab {
namespace {

using frame::Frame;

constexpr std::size_t kMaxSensors = 1000;
constexpr std::size_t kSensorChunk = 1 << 16; ///< [bytes] written at once
constexpr std::chrono::milliseconds kRestOfWriter(100);
constexpr double kLongestWait = 0.25;         ///< [s], simulated, after which less is written
constexpr std::size_t kMostWaiting = 1 << 24; ///< [bytes] that may wait for the disk; then the stepping thread writes
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kPlace[] = {"x [m]", "y [m]", "z [m]"};
constexpr const char* kSpeed[] = {"x [m/s]", "y [m/s]", "z [m/s]"};
constexpr const char* kForce[] = {"x [N]", "y [N]", "z [N]"};

using Columns = std::vector<std::string>;
using Values = std::vector<double>;

void add(Vec3 each, Values& to) { to.insert(to.end(), {each.x, each.y, each.z}); }

/// Refuses a sensor that can read nothing, and says what its columns are.
class SensorCheck {
public:
    SensorCheck(runtime::Simulation& simulation, std::string path) : simulation_(simulation), path_(std::move(path)) {}

    Columns operator()(const PositionSensor& of) const
    {
        const auto def = checkPoint(of.body, of.element, of.node);
        if (!std::holds_alternative<physics::RigidBodyDef>(*def) && of.tip != Vec3{})
            refuse("tip must not be given for ", physics::describeBody(*def),
                   ": only elements of rigid bodies have one");
        return {std::begin(kPlace), std::end(kPlace)};
    }
    Columns operator()(const VelocitySensor& of) const
    {
        static_cast<void>(checkPoint(of.body, of.element, of.node));
        return {std::begin(kSpeed), std::end(kSpeed)};
    }
    Columns operator()(const ContactForceSensor& of) const
    {
        differ(of.body, of.with, "with");
        collides(of.body, "body");
        if (of.with) collides(of.with, "with");
        Columns columns(std::begin(kForce), std::end(kForce));
        columns.emplace_back("normal [N]");
        return columns;
    }
    Columns operator()(const AttachmentForceSensor& of) const
    {
        differ(of.body, of.to, "to");
        if (of.to && of.space) refuse("to must not be given with space");
        return {std::begin(kForce), std::end(kForce)};
    }
    Columns operator()(const JointSensor& of) const
    {
        const auto def = defOf(of.body);
        const auto* rigid = std::get_if<physics::RigidBodyDef>(def.get());
        const std::size_t joints = rigid ? rigid->articulation.joints.size() : 0;
        if (joints == 0) refuse("body must be an articulated one, got ", physics::describeBody(*def));
        checkIndex("joint", of.joint, joints);
        const bool turns =
            rigid->articulation.joints[static_cast<std::size_t>(of.joint)].kind == physics::JointKind::Revolute;
        const std::string force = turns ? " [N m]" : " [N]";
        return {turns ? "position [rad]" : "position [m]", turns ? "velocity [rad/s]" : "velocity [m/s]",
                "force" + force, "load" + force};
    }
    Columns operator()(const CavitySensor& of) const
    {
        const auto def = defOf(of.body);
        const auto* soft = std::get_if<physics::SoftBodyDef>(def.get());
        if (!soft || soft->cavities.empty()) refuse("body must have cavities, got ", physics::describeBody(*def));
        checkIndex("cavity", of.cavity, soft->cavities.size());
        return {"volume [m^3]", "pressure [Pa]", "outflow [m^3/s]", "lost [m^3]"};
    }
    Columns operator()(const DuctSensor& of) const
    {
        const auto def = defOf(of.body);
        if (!hasDuct(of.body, 0)) refuse("body must have a duct, got ", physics::describeBody(*def));
        std::size_t count = 1;
        while (count <= static_cast<std::size_t>(of.duct) && hasDuct(of.body, static_cast<int>(count))) ++count;
        checkIndex("duct", of.duct, count);
        return {"flow [m^3/s]", "leak [m^3/s]", "lost [m^3]", "narrowest [-]"};
    }
    Columns operator()(const BloodSensor& of) const
    {
        const auto def = defOf(of.body);
        if (!simulation_.bleeds(of.body)) refuse("body must be one that bleeds, got ", physics::describeBody(*def));
        return {"welled [m^3]", "on tissue [m^3]", "rate [m^3/s]"};
    }
    Columns operator()(const HeatSensor& of) const
    {
        const auto def = defOf(of.body);
        if (!simulation_.burns(of.body)) refuse("body must be one that burns, got ", physics::describeBody(*def));
        return {"hottest [K]", "burnt [m^2]", "charred [m^2]", "delivered [J]"};
    }
    Columns operator()(const ElectrodeSensor& of) const
    {
        const auto def = defOf(of.body);
        const int has = simulation_.electrodes(of.body);
        if (has == 0) refuse("body must have an electrode, got ", physics::describeBody(*def));
        checkIndex("electrode", of.electrode, static_cast<std::size_t>(has));
        return {"active [s]", "in air [s]", "delivered [J]"};
    }
    Columns operator()(const EnergySensor& of) const
    {
        static_cast<void>(defOf(of.body));
        if (!simulation_.physics().engine().info().energies)
            refuse("body must be one of an engine that tells energies, got '",
                   simulation_.physics().engine().info().name, "'");
        return {"kinetic [J]", "elastic [J]", "gravitational [J]"};
    }
    Columns operator()(const FluidSensor&) const
    {
        if (!has([&] { static_cast<void>(simulation_.distension()); }))
            refuse("type must not be FluidSensor: no fluid distends a cavity");
        return {"pressure [Pa]", "volume [m^3]", "deficit [m^3]", "blood [m^3]"};
    }

private:
    template <class... Words> [[noreturn]] void refuse(const Words&... words) const { fail(path_, words...); }
    /// Whether the simulation has what is asked for.
    template <class Ask> static bool has(const Ask& ask)
    {
        try {
            ask();
            return true;
        } catch (const Error&) {
            return false;
        }
    }
    [[nodiscard]] bool hasDuct(BodyId body, int duct) const
    {
        return has([&] { static_cast<void>(simulation_.duct(body, duct)); });
    }
    void collides(BodyId body, const char* field) const
    {
        const auto def = defOf(body);
        const bool any = std::visit(
            [](const auto& each) {
                if constexpr (requires { each.collision.empty(); })
                    return !each.collision.empty();
                else
                    return each.collision.has_value();
            },
            *def);
        if (!any) refuse(field, " must collide, got ", physics::describeBody(*def), ", which has no collision");
    }
    [[nodiscard]] std::shared_ptr<const physics::BodyDef> defOf(BodyId body) const
    {
        if (!body || !simulation_.physics().has(body)) refuse("body must be one of the simulation");
        return simulation_.physics().def(body);
    }
    void checkIndex(const char* field, int index, std::size_t end) const
    {
        if (index < 0 || static_cast<std::size_t>(index) >= end)
            refuse(field, " must be in [0, ", end, "), got ", index);
    }
    [[nodiscard]] std::shared_ptr<const physics::BodyDef> checkPoint(BodyId body, int element,
                                                                     const std::optional<int>& node) const
    {
        const auto def = defOf(body);
        checkBodyPoint(*def, element, node, path_);
        return def;
    }
    void differ(BodyId body, BodyId other, const char* field) const
    {
        static_cast<void>(defOf(body));
        if (!other) return;
        if (!simulation_.physics().has(other)) refuse(field, " must be a body of the simulation");
        if (body == other) refuse(field, " must differ from body");
    }

    runtime::Simulation& simulation_;
    const std::string path_; ///< "sensors: sensors[2]."
};

/// Appends what a sensor reads to `values`. What is not known is left out.
class SensorReader {
public:
    SensorReader(runtime::Simulation& simulation, const Frame& frame, Values& values)
        : simulation_(simulation), frame_(frame), values_(values)
    {
    }

    void operator()(const PositionSensor& of) const
    {
        if (const auto place = pointOf(frame_, of.body, of.element, of.tip, of.node)) add(*place, values_);
    }
    void operator()(const VelocitySensor& of) const
    {
        if (const auto* rigid = frame_.rigidBody(of.body)) {
            const auto element = static_cast<std::size_t>(of.element);
            if (element < rigid->velocities.size()) add(rigid->velocities[element], values_);
        } else if (const auto* soft = frame_.softBody(of.body)) {
            Vec3 sum;
            for (const Vec3& each : soft->velocities) sum += each;
            add(of.node ? soft->velocities[static_cast<std::size_t>(*of.node)]
                        : sum / static_cast<double>(soft->velocities.size()),
                values_);
        }
    }
    void operator()(const ContactForceSensor& of) const
    {
        if (!known(of.body)) return;
        Vec3 force;
        double normal = 0.0;
        for (const frame::Contact& each : frame_.contacts) {
            if (each.first == each.second || (each.first != of.body && each.second != of.body)) continue;
            if (of.with && (each.first == of.body ? each.second : each.first) != of.with) continue;
            force += frame::forceOn(of.body, each);
            normal += each.normalForce;
        }
        add(force, values_);
        values_.push_back(normal);
    }
    void operator()(const AttachmentForceSensor& of) const
    {
        if (!known(of.body)) return;
        Vec3 force;
        for (const frame::Attachment& each : frame_.attachments) {
            const bool first = each.body == of.body;
            if (!first && each.to != of.body) continue;
            if (of.to && (first ? each.to : each.body) != of.to) continue;
            if (of.space && each.to) continue;
            force += first ? each.force : -each.force;
        }
        add(force, values_);
    }
    void operator()(const JointSensor& of) const
    {
        const auto* rigid = frame_.rigidBody(of.body);
        const auto joint = static_cast<std::size_t>(of.joint);
        if (!rigid || joint >= rigid->joints.size()) return;
        const frame::Joint& now = rigid->joints[joint];
        values_.insert(values_.end(), {now.position, now.velocity, now.force, now.load});
    }
    void operator()(const CavitySensor& of) const
    {
        for (const frame::Cavity& each : frame_.cavities)
            if (each.body == of.body && each.cavity == of.cavity)
                values_.insert(values_.end(), {each.volume, each.pressure, each.outflow, each.lost});
    }
    void operator()(const DuctSensor& of) const
    {
        if (!known(of.body)) return;
        const surface::DuctBalance now = simulation_.duct(of.body, of.duct);
        values_.insert(values_.end(), {now.flow, now.leak, now.lost, now.narrowest});
    }
    void operator()(const BloodSensor& of) const
    {
        if (!known(of.body)) return;
        const surface::BloodBalance now = simulation_.blood(of.body);
        values_.insert(values_.end(), {now.welled, now.onTissue, now.rate});
    }
    void operator()(const HeatSensor& of) const
    {
        if (!known(of.body)) return;
        const surface::HeatBalance now = simulation_.heat(of.body);
        if (now.hottest == 0.0) return; // the first step of its heat is yet to come
        values_.insert(values_.end(), {now.hottest, now.burnt, now.charred, now.delivered});
    }
    void operator()(const ElectrodeSensor& of) const
    {
        if (!known(of.body)) return;
        const surface::EnergyBalance now = simulation_.energy(of.body, of.electrode);
        values_.insert(values_.end(), {now.active, now.inAir, now.delivered});
    }
    void operator()(const EnergySensor& of) const
    {
        if (!known(of.body)) return;
        const physics::MechanicalEnergy now = simulation_.physics().mechanicalEnergy(of.body);
        values_.insert(values_.end(), {now.kinetic, now.elastic, now.gravitational});
    }
    void operator()(const FluidSensor&) const
    {
        const surface::DistensionBalance now = simulation_.distension();
        values_.insert(values_.end(), {now.pressure, now.volume, surface::deficit(now), now.blood});
    }

private:
    /// Whether it is there in the frame, and so everywhere else.
    [[nodiscard]] bool known(BodyId body) const { return frame_.softBody(body) || frame_.rigidBody(body); }

    runtime::Simulation& simulation_;
    const Frame& frame_;
    Values& values_;
};

SensorsDef checkedDef(SensorsDef def)
{
    validate(def, "sensors");
    if (def.sensors.empty() || def.sensors.size() > kMaxSensors)
        fail("sensors: there must be 1 to ", kMaxSensors, " sensors, got ", def.sensors.size());
    if (!def.file.empty() && !def.file.ends_with(".csv"))
        fail("sensors: file must end in .csv, got ", shownWord(def.file));
    std::set<std::string> known;
    for (std::size_t i = 0; i < def.sensors.size(); ++i) {
        std::string& name = def.sensors[i].name;
        if (name.empty()) name = text("sensor ", i + 1);
        checkName(name, text("sensors: sensors[", i, "]"));
        if (!known.insert(name).second)
            fail("sensors: sensors[", i, "].name must differ from those before it, got ", shownWord(name));
    }
    return def;
}

} // namespace

struct Sensors::Impl {
    Impl(runtime::Simulation& sim, SensorsDef asked) : simulation(sim), def(checkedDef(std::move(asked)))
    {
        for (std::size_t i = 0; i < def.sensors.size(); ++i)
            columns.push_back(std::visit(SensorCheck(sim, text("sensors: sensors[", i, "].")), def.sensors[i].kind));
        if (def.file.empty()) return;
        file.emplace(def.file);
        waiting = "time [s]";
        for (std::size_t i = 0; i < columns.size(); ++i)
            for (const std::string& column : columns[i])
                waiting += ',' + metric::csvCell(text(def.sensors[i].name, ' ', column));
        waiting += '\n';
        writer = std::thread([this] { run(); });
    }
    ~Impl() { close(); }

    /// What each sensor reads in a frame, one after the other.
    [[nodiscard]] Values valuesIn(const Frame* frame) const
    {
        Values values;
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const std::size_t begin = values.size();
            try {
                if (frame) std::visit(SensorReader(simulation, *frame, values), def.sensors[i].kind);
            } catch (const Error&) { // the body was removed since that state
                values.resize(begin);
            }
            values.resize(begin + columns[i].size(), kUnknown);
        }
        return values;
    }

    // Stepping thread.

    void observe()
    {
        const std::unique_lock lock(sampling, std::try_to_lock); // close() ends
        if (lock && !closed) take();
    }
    /// A line of the newest state, if it is due. Called with the lock.
    void take()
    {
        const frame::FrameRef frame = simulation.physics().latest();
        if (!frame || frame->time <= seen) return;
        seen = frame->time;
        const double period = std::floor(seen * def.rate + 1e-6);
        if (period <= lastPeriod) return;
        lastPeriod = period;
        const Values values = valuesIn(&*frame);
        waiting += text(seen);
        for (const double value : values) {
            waiting += ',';
            if (std::isfinite(value)) waiting += text(value);
        }
        waiting += '\n';
        if (waiting.size() > kSensorChunk || seen - handedOver >= kLongestWait) handOver();
    }
    /// Passes the lines on to be written; if the other thread takes some just now, with the next line.
    void handOver()
    {
        {
            const std::unique_lock lock(passing, std::try_to_lock);
            if (!lock) return;
            passed += std::exchange(waiting, {});
            handedOver = seen;
            if (passed.size() <= kMostWaiting) return;
        }
        write();
    }

    // The writing thread, which is not woken: that would be a system call on the stepping one.

    void run()
    {
        for (bool last = false; !last;) {
            {
                std::unique_lock lock(resting);
                last = ending.wait_for(lock, kRestOfWriter, [this] { return stopping; });
            }
            write();
        }
    }

    // Any thread.

    void write()
    {
        const std::lock_guard lock(writing);
        std::string chunk;
        {
            const std::lock_guard taking(passing);
            chunk = std::exchange(passed, {});
        }
        if (chunk.empty()) return;
        attempt([&] {
            file->write(chunk), file->flush();
            written += static_cast<std::uint64_t>(std::ranges::count(chunk, '\n'));
        });
    }
    /// After a failure nothing more is written.
    void attempt(const std::function<void()>& write)
    {
        if (failed.load()) return;
        const std::optional<std::string> problem = guardedCall(write);
        if (!problem) return;
        failed.store(true);
        tellFileFailure(simulation, text("sensors: ", *problem, "; the run goes on without them"));
    }
    void close()
    {
        const std::lock_guard lock(sampling);
        if (std::exchange(closed, true) || !file) return;
        if (const auto problem = guardedCall([this] { take(); }))
            logWarning("sensors: the last state is not in the table: ", *problem);
        {
            const std::lock_guard passOn(passing);
            passed += std::exchange(waiting, {});
        }
        {
            const std::lock_guard end(resting);
            stopping = true;
        }
        ending.notify_one();
        writer.join(); // it has written all
        attempt([this] { file->close(); });
    }

    runtime::Simulation& simulation;
    const SensorsDef def;
    std::vector<Columns> columns;           ///< one list per sensor
    std::atomic<std::uint64_t> written = 0; ///< [-], lines, the head among them
    std::atomic<bool> failed = false;

    std::mutex
        sampling; ///< held while a state is read: by the stepping thread, which never waits for it, or by close()
    bool closed = false;
    double seen = -1.0, lastPeriod = -1.0; ///< [s], the newest state; [-]
    std::string waiting;                   ///< lines that are not handed over
    double handedOver = 0.0;               ///< [s], simulated

    std::mutex passing; ///< held for moments
    std::string passed; ///< lines to be written
    std::mutex writing; ///< held by who writes; before `passing`
    std::optional<OutputFile> file;

    std::mutex resting;
    std::condition_variable ending;
    bool stopping = false;
    std::thread writer; // last, because it uses all members above
};

Sensors::Sensors(runtime::Simulation& simulation, SensorsDef def)
    : impl_(std::make_shared<Impl>(simulation, std::move(def)))
{
    if (!impl_->file) return;
    const std::weak_ptr<Impl> weak = impl_;
    simulation.everyStep([weak](double) {
        if (const auto impl = weak.lock()) impl->observe();
    });
    simulation.remember({.of = "sensors",
                         .save =
                             [weak] {
                                 const auto impl = weak.lock();
                                 return impl ? std::any(true) : std::any(); // there is a table
                             },
                         .restore = [](const std::any&) {},
                         .check =
                             [weak](const std::any&) {
                                 const auto impl = weak.lock();
                                 if (!impl) return;
                                 const std::lock_guard lock(impl->sampling);
                                 if (!impl->closed)
                                     fail("restore: sensors are written to '", shortened(impl->def.file),
                                          "', where time only goes on");
                             }});
}

Sensors::~Sensors() { close(); }

std::vector<SensorReading> Sensors::read() const
{
    const frame::FrameRef frame = impl_->simulation.physics().latest();
    const Values values = impl_->valuesIn(frame ? &*frame : nullptr);
    std::vector<SensorReading> out;
    auto next = values.begin();
    for (std::size_t i = 0; i < impl_->columns.size(); ++i) {
        const auto count = static_cast<std::ptrdiff_t>(impl_->columns[i].size());
        out.push_back({impl_->def.sensors[i].name, impl_->columns[i], Values(next, next + count)});
        next += count;
    }
    return out;
}

void Sensors::close() { impl_->close(); }
std::uint64_t Sensors::lines() const
{
    const std::uint64_t written = impl_->written.load();
    return written > 0 ? written - 1 : 0;
}
bool Sensors::failed() const { return impl_->failed.load(); }

} // namespace filasofia::prefab
