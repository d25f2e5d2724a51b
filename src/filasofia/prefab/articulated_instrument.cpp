#include "filasofia/prefab/articulated_instrument.h"

#include "filasofia/core/published.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/math/rounded.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/turns.h"
#include "filasofia/runtime/assets.h"

#include <algorithm>
#include <tuple>

namespace filasofia::prefab {
namespace {

using physics::JointDef;
using physics::JointForce;
using physics::JointPosition;

std::string part(std::string_view name) { return runtime::asset(text("meshes/hysteroscopy/", name)); }

bool isEmpty(const physics::TriangleMeshSource& source)
{
    const auto* file = std::get_if<std::string>(&source);
    return file != nullptr && file->empty();
}

/// The jaws that come with Filasofia (assets/meshes/hysteroscopy/instruments.json).
std::vector<JawDef> jawsOf(InstrumentKind kind)
{
    constexpr double degree = std::numbers::pi / 180.0;
    std::vector<JawDef> jaws;
    for (const bool upper : {true, false}) {
        const std::string_view side = upper ? "upper" : "lower";
        JawDef jaw{.axis = {upper ? 1.0 : -1.0, 0.0, 0.0}};
        if (kind == InstrumentKind::Scissors) {
            // A collision mesh of the blade would push away what its edge has to cut, so only the edge touches tissue.
            const double y = upper ? -0.06e-3 : 0.06e-3;
            jaw.edge = {{{0.0, y, -1.0e-3}, {0.0, y, -6.4e-3}}};
            jaw.opensBy = 35.0 * degree;
            jaw.surface = part(text("scissors_blade_", side, ".obj"));
        } else {
            const std::string_view name = kind == InstrumentKind::Forceps ? "forceps" : "grasper";
            jaw.opensBy = (kind == InstrumentKind::Forceps ? 45.0 : 40.0) * degree;
            jaw.surface = part(text(name, "_jaw_", side, ".obj"));
            jaw.collision = part(text(name, "_jaw_", side, "_collision.obj"));
        }
        jaws.push_back(jaw);
    }
    return jaws;
}

ArticulatedInstrumentDef completed(ArticulatedInstrumentDef def)
{
    const std::string object = text("instrument '", def.name, "'");
    validate(def, object);
    def.pose = physics::unitPose(def.pose, text(object, ": pose"));
    if (def.jaws.empty()) def.jaws = jawsOf(def.kind);
    if (def.jaws.size() > 2) fail(object, ": jaws must have one or two entries, got ", def.jaws.size());
    if (std::ranges::none_of(def.jaws, [](const JawDef& jaw) { return jaw.opensBy > 0.0; }))
        fail(object, ": jaws: at least one must have opensBy > 0 rad, got none");
    for (std::size_t i = 0; i < def.jaws.size(); ++i) {
        if (length(def.jaws[i].axis) == 0.0) fail(object, ": jaws[", i, "].axis must have a length > 0, got 0 0 0");
        if (const auto& edge = def.jaws[i].edge; edge && distance((*edge)[0], (*edge)[1]) == 0.0)
            fail(object, ": jaws[", i, "].edge must have a length > 0 m, got 0");
    }
    if (isEmpty(def.shaft)) def.shaft = part("tool_shaft.obj");
    if (isEmpty(def.shaftCollision)) def.shaftCollision = part("tool_shaft_collision.obj");
    if (def.kind == InstrumentKind::Scissors) def.grasps = false;
    return def;
}

/// A cutting edge as a surface, because collision models are surfaces: a strip a tenth as wide as it is long, whose rim
/// cuts.
std::shared_ptr<const geometry::TriangleMesh> blade(const JawDef& jaw)
{
    const auto [from, to] = *jaw.edge;
    const Vec3 back = 0.1 * distance(from, to) * normalized(cross(to - from, jaw.axis));
    return std::make_shared<geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {from, to, from - back}, .triangles = {{0, 1, 2}}, .uv = {}});
}

/// A position-controlled joint that under the closing torque moves at `speed`, which it reaches in 20 ms.
JointDef jointOf(const ArticulatedInstrumentDef& def, const JawDef& jaw, int link)
{
    const double damping = def.closingTorque / def.speed;
    JointDef joint{.axis = jaw.axis, .child = link, .lower = 0.0, .upper = jaw.opensBy};
    joint.start = def.opening * jaw.opensBy;
    joint.command = JointPosition{joint.start};
    joint.speed = def.speed;
    joint.damping = damping;
    joint.inertia = 0.02 * damping;
    // A jaw weighs little compared with its drive: a tenth of a gram, 3 mm long.
    joint.mass = physics::GivenInertia{.mass = 1e-4, .centre = {0.0, 0.0, -3e-3}, .moments = {1e-9, 1e-9, 1e-9}};
    return joint;
}

/// The forces of tissue on the two sides of the mouth [N]: across the shaft, along the direction in which a jaw opens
/// and against it.
std::array<double, 2> squeezed(const frame::Frame& frame, BodyId tool, BodyId target, Vec3 opens)
{
    std::array<double, 2> sides = {};
    for (const frame::Contact& contact : frame.contacts) {
        const bool first = contact.first == tool && contact.second == target;
        if (!first && !(contact.second == tool && contact.first == target)) continue;
        const double along = dot(first ? contact.normal : -contact.normal, opens) * contact.normalForce;
        sides[along > 0.0 ? 0 : 1] += std::abs(along);
    }
    return sides;
}

} // namespace

struct ArticulatedInstrument::Impl {
    enum class State {
        Open,      ///< goes to the commanded angle; holds nothing
        Closing,   ///< presses
        Requested, ///< has asked for a grasp, and waits for the step that makes it
        Holding,   ///< attached to the tissue it holds
        Slipped    ///< presses, and holds nothing until it has been opened
    };

    Impl(runtime::Simulation& sim, const ArticulatedInstrumentDef& asked)
        : simulation(sim), def(completed(asked)), lastPose(def.pose), newest({.pose = lastPose}), body(addBody())
    {
        simulation.show(body, {.surface = def.shaft, .element = kShaft, .material = def.material});
        for (std::size_t i = 0; i < def.jaws.size(); ++i)
            if (!isEmpty(def.jaws[i].surface))
                simulation.show(body,
                                {.surface = def.jaws[i].surface, .element = elementOf(i), .material = def.material});
    }

    [[nodiscard]] int elementOf(std::size_t jaw) const
    {
        if (def.jaws[jaw].opensBy == 0.0) return kShaft;
        return 1 + static_cast<int>(std::count_if(def.jaws.begin(), def.jaws.begin() + static_cast<long>(jaw),
                                                  [](const JawDef& each) { return each.opensBy > 0.0; }));
    }

    BodyId addBody()
    {
        physics::RigidBodyDef rigid{.name = def.name, .elements = {def.pose}, .friction = def.friction};
        for (std::size_t i = 0; i < def.jaws.size(); ++i)
            if (elementOf(i) != kShaft) rigid.articulation.joints.push_back(jointOf(def, def.jaws[i], elementOf(i)));
        for (const int group : def.groups) {
            const auto touch = [&](const physics::TriangleMeshSource& mesh, int element, bool cutting) {
                rigid.collision.push_back(
                    {.mesh = mesh, .element = element, .proximity = def.proximity, .group = group, .cutting = cutting});
            };
            touch(def.shaftCollision, kShaft, false);
            for (std::size_t i = 0; i < def.jaws.size(); ++i) {
                if (!isEmpty(def.jaws[i].collision)) touch(def.jaws[i].collision, elementOf(i), false);
                if (def.jaws[i].edge) touch(blade(def.jaws[i]), elementOf(i), true);
            }
        }
        return simulation.add(rigid);
    }

    /// Gives every moving jaw the command for its joint and Def.
    template <class CommandOf> void commandJaws(CommandOf commandOf)
    {
        int joint = 0;
        for (const JawDef& jaw : def.jaws)
            if (jaw.opensBy > 0.0) {
                simulation.physics().setJoint(body, joint, commandOf(static_cast<std::size_t>(joint), jaw));
                ++joint;
            }
    }
    void press()
    {
        commandJaws([this](std::size_t, const JawDef&) { return physics::JointCommand(JointForce{-torque}); });
    }

    void release()
    {
        if (grip) simulation.physics().release(grip);
        if (state == State::Holding && def.onGrasp) {
            publish(); // because onGrasp may ask for it
            def.onGrasp(held, false);
        }
        grip = {};
        held = {};
        force = 0.0;
    }

    // Stepping thread, before each step.
    void watch()
    {
        const frame::FrameRef frame = simulation.physics().latest();
        if (!frame) return;
        const frame::RigidBodyFrame* now = frame->rigidBody(body);
        if (now == nullptr) return;
        // If another thread is opening or closing the instrument, this waits for the next step.
        turns.now([&] {
            widest = widestOf(*now);
            if (state == State::Closing && def.grasps)
                seek(*frame, *now);
            else if (state == State::Requested || state == State::Holding)
                follow(*frame);
            publish();
        });
    }

    /// Any thread. The stepping thread does not wait for others.
    template <class Act> void act(Act what)
    {
        turns.take(!simulation.physics().stepsHere(), [this, what] {
            what(*this);
            publish();
        });
    }

    void publish()
    {
        newest.write(
            {.pose = lastPose, .holding = state == State::Holding ? held : BodyId{}, .force = force, .widest = widest});
    }

    using Kept = std::tuple<Pose, State, double, AttachmentId, BodyId, std::uint64_t, double, double>;
    auto kept() { return std::tie(lastPose, state, torque, grip, held, requestedAt, force, widest); }

    [[nodiscard]] double widestOf(const frame::RigidBodyFrame& now) const
    {
        double widestFraction = 0.0;
        std::size_t joint = 0;
        for (const JawDef& jaw : def.jaws)
            if (jaw.opensBy > 0.0)
                widestFraction = std::max(widestFraction, now.joints[joint++].position / jaw.opensBy);
        return widestFraction;
    }

    /// Looks for tissue between the jaws. The ids of soft bodies ascend: the first squeezed body is held.
    void seek(const frame::Frame& frame, const frame::RigidBodyFrame& now)
    {
        const JawDef& jaw = def.jaws.front();
        const Vec3 opens = rotate(now.poses.front().orientation, normalized(cross(jaw.axis, Vec3{0.0, 0.0, -1.0})));
        for (const frame::SoftBodyFrame& soft : frame.softBodies) {
            const auto sides = squeezed(frame, body, soft.id, opens);
            if (sides[0] < def.gripForce || sides[1] < def.gripForce) continue;
            grip = simulation.physics().grasp(body, soft.id,
                                              {.stiffness = def.gripStiffness, .breakForce = def.breakForce});
            commandJaws([&](std::size_t joint, const JawDef& each) {
                const double position = std::clamp(now.joints[joint].position, 0.0, each.opensBy);
                return physics::JointCommand(JointPosition{position});
            });
            held = soft.id;
            requestedAt = frame.step;
            state = State::Requested;
            return;
        }
    }

    /// Checks whether the grasp has been made and still holds.
    void follow(const frame::Frame& frame)
    {
        const auto found =
            std::ranges::find_if(frame.attachments, [this](const frame::Attachment& each) { return each.id == grip; });
        const bool there = found != frame.attachments.end() && !found->broken && found->points > 0;
        if (there) {
            force = length(found->force);
            if (state == State::Requested && def.onGrasp) {
                publish(); // because onGrasp may ask for it
                def.onGrasp(held, true);
            }
            state = State::Holding;
        } else if (frame.step > requestedAt) {
            const bool slipped = state == State::Holding;
            release();
            state = slipped ? State::Slipped : State::Closing;
            press();
        }
    }

    runtime::Simulation& simulation;
    const ArticulatedInstrumentDef def;
    Turns turns; // guards the members below and the order of commands; onGrasp may call back
    Pose lastPose;
    State state = State::Open;
    double torque = 0.0;
    AttachmentId grip = {};
    BodyId held = {};
    std::uint64_t requestedAt = 0;
    double force = 0.0;
    double widest = 0.0;
    struct Snapshot {
        Pose pose = {};
        BodyId holding = {};
        double force = 0.0;
        double widest = 0.0;
    };
    Published<Snapshot> newest; // for all threads
    const BodyId body;          // built from the Def
};

ArticulatedInstrument::ArticulatedInstrument(runtime::Simulation& simulation, const ArticulatedInstrumentDef& def)
    : impl_(std::make_shared<Impl>(simulation, def))
{
    simulation.everyStep([weak = std::weak_ptr(impl_)](double) {
        if (const auto impl = weak.lock()) impl->watch();
    });
    remember(simulation, text("instrument '", impl_->def.name, "'"), impl_);
}
ArticulatedInstrument::~ArticulatedInstrument() = default;

BodyId ArticulatedInstrument::body() const { return impl_->body; }

void ArticulatedInstrument::move(const Pose& pivot)
{
    const Pose unit = physics::unitPose(pivot, text("instrument '", impl_->def.name, "'"));
    impl_->act([unit](Impl& impl) {
        impl.lastPose = unit;
        impl.simulation.physics().setPose(impl.body, rounded(unit), kShaft);
    });
}

void ArticulatedInstrument::open(double opening)
{
    if (!(opening >= 0.0 && opening <= 1.0))
        fail("instrument '", impl_->def.name, "': open must be in [0, 1], got ", opening);
    impl_->act([opening](Impl& impl) {
        impl.release();
        impl.state = Impl::State::Open;
        impl.commandJaws([&](std::size_t, const JawDef& jaw) {
            return physics::JointCommand(JointPosition{opening * jaw.opensBy});
        });
    });
}

void ArticulatedInstrument::close(std::optional<double> torque)
{
    if (torque && !(*torque > 0.0 && std::isfinite(*torque)))
        fail("instrument '", impl_->def.name, "': close: torque must be > 0 N m, got ", *torque);
    impl_->act([torque](Impl& impl) {
        impl.torque = torque.value_or(impl.def.closingTorque);
        if (impl.state == Impl::State::Requested || impl.state == Impl::State::Holding) return; // it is closed already
        if (impl.state == Impl::State::Open) impl.state = Impl::State::Closing;
        impl.press();
    });
}

Pose ArticulatedInstrument::pose() const { return impl_->newest.read().pose; }
BodyId ArticulatedInstrument::holding() const { return impl_->newest.read().holding; }
double ArticulatedInstrument::pull() const { return impl_->newest.read().force; }
double ArticulatedInstrument::opening() const { return impl_->newest.read().widest; }

} // namespace filasofia::prefab
