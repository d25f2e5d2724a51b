#include "filasofia/prefab/articulated_instrument.h"

#include "filasofia/core/published.h"
#include "filasofia/core/text.h"
#include "filasofia/math/rounded.h"
#include "filasofia/prefab/instrument_kind.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/turns.h"

#include <algorithm>
#include <tuple>

namespace filasofia::prefab {
namespace {

using physics::JointDef;
using physics::JointForce;
using physics::JointPosition;

/// A cutting edge as a surface, because collision models are surfaces: a strip a tenth as wide as it is long, whose rim
/// cuts.
std::shared_ptr<const geometry::TriangleMesh> blade(const JawDef& jaw)
{
    const auto [from, to] = *jaw.edge;
    const Vec3 back = 0.1 * distance(from, to) * normalized(cross(to - from, jaw.axis));
    return std::make_shared<geometry::TriangleMesh>(
        geometry::TriangleMesh{.vertices = {from, to, from - back}, .triangles = {{0, 1, 2}}, .uv = {}});
}

constexpr double kAcross = 0.7;    ///< [-] cosine between a thread and the way jaws open: beyond it is not between them
constexpr double kRelief = 0.2e-3; ///< [m], by which jaws give way at a rigid body that they hold by a spring

/// A position-controlled joint that under the closing torque moves at `speed`, which it reaches in 20 ms.
JointDef jointOf(const ArticulatedInstrumentDef& def, const JawDef& jaw, int link)
{
    const double damping = *def.closingTorque / def.speed;
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

bool isBetween(const frame::Contact& contact, BodyId one, BodyId two)
{
    return (contact.first == one && contact.second == two) || (contact.first == two && contact.second == one);
}

/// The mouth of an instrument, and where that is.
struct Mouth {
    BodyId tool = {};
    Pose shaft = {};
    physics::Mouth jaws = {}; ///< in the coordinates of the shaft

    [[nodiscard]] Vec3 pivot() const { return shaft.position; }
    [[nodiscard]] Vec3 opens() const { return rotate(shaft.orientation, jaws.opens); } ///< in the world
};

/// Where a contact pushes the tool to.
Vec3 pushOf(const frame::Contact& contact, const Mouth& mouth)
{
    return contact.first == mouth.tool ? contact.normal : -contact.normal;
}

/// Whether a contact is between the jaws. A thread that is wound around the shaft, or around the jaws, presses both of
/// their sides, too.
bool isInMouth(const frame::Contact& contact, const Mouth& mouth)
{
    return physics::isInMouth(mouth.jaws, mouth.shaft, contact.point, pushOf(contact, mouth));
}

/// The forces of tissue on the two sides of the mouth [N]: across the shaft, along the direction in which a jaw opens
/// and against it.
std::array<double, 2> squeezed(const frame::Frame& frame, const Mouth& mouth, BodyId target)
{
    std::array<double, 2> sides = {};
    for (const frame::Contact& contact : frame.contacts) {
        if (!isBetween(contact, mouth.tool, target) || !isInMouth(contact, mouth)) continue;
        const double press = dot(pushOf(contact, mouth), mouth.opens()) * contact.normalForce;
        sides[press > 0.0 ? 0 : 1] += std::abs(press);
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
        : simulation(sim), def(completed(asked)), lastPose(def.pose), newest({.pose = lastPose, .widest = widest}),
          body(addBody())
    {
        simulation.show(
            body, {.surface = def.shaft, .element = kShaft, .material = def.shaftMaterial.value_or(def.material)});
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
        gripAt = carried;
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
        newest.write({.pose = lastPose,
                      .holding = state == State::Holding ? held : BodyId{},
                      .force = force,
                      .widest = widest,
                      .gripAt = gripAt});
    }

    using Kept = std::tuple<Pose, State, double, AttachmentId, BodyId, std::uint64_t, double, double, Vec3>;
    auto kept() { return std::tie(lastPose, state, torque, grip, held, requestedAt, force, widest, gripAt); }

    [[nodiscard]] double widestOf(const frame::RigidBodyFrame& now) const
    {
        double widestFraction = 0.0;
        std::size_t joint = 0;
        if (now.joints.empty()) return state == State::Open ? 1.0 : 0.0;
        for (const JawDef& jaw : def.jaws)
            if (jaw.opensBy > 0.0)
                widestFraction = std::max(widestFraction, now.joints[joint++].position / jaw.opensBy);
        return widestFraction;
    }

    /// Tissue and threads, and rigid bodies that nobody else moves.
    [[nodiscard]] bool canBeHeld(BodyId id) const
    {
        const auto* rigid = std::get_if<physics::RigidBodyDef>(simulation.physics().def(id).get());
        return rigid == nullptr || (rigid->dynamic && rigid->articulation.joints.empty());
    }

    /// [m], the mean of the contacts with the held body, by their forces.
    [[nodiscard]] Vec3 middleOfContacts(const frame::Frame& frame, const Mouth& mouth) const
    {
        double all = 0.0;
        Vec3 middle;
        for (const frame::Contact& contact : frame.contacts) {
            if (!isBetween(contact, body, held) || !isInMouth(contact, mouth)) continue;
            middle += contact.normalForce * contact.point;
            all += contact.normalForce;
        }
        return 1.0 / all * middle;
    }
    static auto nearest(const std::vector<Pose>& poses, Vec3 place)
    {
        return std::ranges::min_element(poses, {}, [&](const Pose& each) { return distance(each.position, place); });
    }

    /// Contacts are points, and a jaw on a needle is not: the needle is fixed to a jaw, in any orientation, as long as
    /// friction would bear the force. Both jaws press with the closing torque at the contacts' mean distance from the
    /// pivot.
    [[nodiscard]] physics::RigidAttachmentDef rigidGrip(const frame::Frame& frame, const Mouth& mouth) const
    {
        double lever = 0.0, all = 0.0;
        for (const frame::Contact& contact : frame.contacts) {
            if (!isBetween(contact, body, held) || !isInMouth(contact, mouth)) continue;
            lever += contact.normalForce * distance(contact.point, mouth.pivot());
            all += contact.normalForce;
        }
        const auto& poses = frame.rigidBody(held)->poses;
        const auto near = nearest(poses, middleOfContacts(frame, mouth));
        const double other = std::get<physics::RigidBodyDef>(*simulation.physics().def(held)).friction;
        const double most = 2.0 * std::sqrt(def.friction * other) * torque * all / lever;
        return {.element = static_cast<int>(near - poses.begin()),
                .stiffness = def.gripStiffness,
                .to = body,
                .toElement = elementOf(0),
                .breakForce = std::min(def.breakForce, most)};
    }

    /// Holds what the jaws touch. A thread may be wound around shaft or jaws as well, where it has to go on sliding:
    /// then its nodes between the jaws are held in place of all contacts.
    [[nodiscard]] AttachmentId softGrip(const frame::Frame& frame, const Mouth& mouth) const
    {
        const auto asked = simulation.physics().def(held);
        const auto* rod = std::get_if<physics::RodBodyDef>(asked.get());
        const auto touches = [&](const frame::Contact& each, bool inMouth) {
            return isBetween(each, body, held) && isInMouth(each, mouth) == inMouth;
        };
        const auto wound = [&](const frame::Contact& each) { return touches(each, false); };
        if (rod == nullptr || std::ranges::none_of(frame.contacts, wound))
            return simulation.physics().grasp(
                body, held, {.stiffness = def.gripStiffness, .breakForce = def.breakForce, .mouth = mouth.jaws});
        const std::vector<Vec3>& nodes = frame.softBody(held)->positions;
        physics::AttachmentDef jaws{.stiffness = def.gripStiffness, .to = body, .breakForce = def.breakForce};
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const Vec3 before = nodes[i > 0 ? i - 1 : i], after = nodes[std::min(i + 1, nodes.size() - 1)];
            const double edge = std::max(distance(nodes[i], before), distance(nodes[i], after));
            const double near = rod->radius + def.proximity + 0.5 * edge; // so that each contact finds a node
            // A thread that lies around closed jaws touches the rims of their mouth, too, but it runs across it.
            const bool across = std::abs(dot(normalized(after - before), mouth.opens())) > kAcross;
            if (!across && std::ranges::any_of(frame.contacts, [&](const frame::Contact& each) {
                    return touches(each, true) && distance(each.point, nodes[i]) <= near;
                }))
                jaws.nodes.push_back(static_cast<int>(i));
        }
        if (jaws.nodes.empty()) return {};
        return simulation.physics().attach(held, jaws);
    }

    [[nodiscard]] Mouth mouthOf(const frame::RigidBodyFrame& now) const
    {
        std::array<double, 2> angles = {};
        for (std::size_t i = 0; i < def.jaws.size(); ++i)
            if (const int element = elementOf(i); element != kShaft)
                angles[i] = now.joints[static_cast<std::size_t>(element - 1)].position;
        // If the jaws do not open by the same angle, the plane between them inclines.
        const Vec3 forward = {0.0, 0.0, -1.0};
        const double slope = std::tan(0.5 * (angles[0] - angles[1]));
        const Vec3 opens = normalized(cross(def.jaws.front().axis, forward)) - slope * forward;
        return {.tool = body,
                .shaft = now.poses.front(),
                .jaws = {.element = kShaft, .forward = forward, .opens = normalized(opens)}};
    }

    /// The first of these bodies (their ids ascend) that both sides of the mouth press with `gripForce`; 0 if none.
    template <class Bodies>
    [[nodiscard]] BodyId between(const frame::Frame& frame, const Mouth& mouth, const Bodies& bodies) const
    {
        const auto isPressed = [&](const auto& each) {
            const auto sides = squeezed(frame, mouth, each.id);
            return sides[0] >= def.gripForce && sides[1] >= def.gripForce && canBeHeld(each.id);
        };
        const auto found = std::ranges::find_if(bodies, isPressed);
        return found == bodies.end() ? BodyId{} : found->id;
    }

    /// Looks for a body between the jaws and asks for a grasp. A rigid one comes first: a needle, with tissue around
    /// it.
    void seek(const frame::Frame& frame, const frame::RigidBodyFrame& now)
    {
        const Mouth mouth = mouthOf(now);
        held = between(frame, mouth, frame.rigidBodies);
        if (!held) held = between(frame, mouth, frame.softBodies);
        if (!held) return;
        const frame::RigidBodyFrame* rigid = frame.rigidBody(held);
        const Vec3 middle = middleOfContacts(frame, mouth);
        grip = rigid ? simulation.physics().attach(held, rigidGrip(frame, mouth)) : softGrip(frame, mouth);
        if (!grip) {
            held = {};
            return;
        }
        gripAt = transform(inverse(now.poses.front()), rigid ? nearest(rigid->poses, middle)->position : middle);
        // A spring that holds a rigid body and jaws that stand still would work against each other: the jaws give way.
        const bool springs = rigid != nullptr && std::isfinite(def.gripStiffness);
        const double relief = springs ? kRelief / std::max(kRelief, distance(middle, mouth.pivot())) : 0.0;
        commandJaws([&](std::size_t joint, const JawDef& each) {
            const double position = std::clamp(now.joints[joint].position + relief, 0.0, each.opensBy);
            return physics::JointCommand(JointPosition{position});
        });
        requestedAt = frame.step;
        state = State::Requested;
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
    double widest = def.opening;
    Vec3 gripAt = {};  ///< [m], where the held body pulls, in the coordinates of the pivot
    Vec3 carried = {}; ///< [m], the same of what is fixed to it
    struct Snapshot {
        Pose pose = {};
        BodyId holding = {};
        double force = 0.0;
        double widest = 0.0;
        Vec3 gripAt = {};
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
        impl.torque = torque.value_or(*impl.def.closingTorque);
        if (impl.state == Impl::State::Requested || impl.state == Impl::State::Holding) return; // it is closed already
        if (impl.state == Impl::State::Open) impl.state = Impl::State::Closing;
        impl.press();
    });
}

Pose ArticulatedInstrument::pose() const { return impl_->newest.read().pose; }
BodyId ArticulatedInstrument::holding() const { return impl_->newest.read().holding; }
double ArticulatedInstrument::pull() const { return impl_->newest.read().force; }
Vec3 ArticulatedInstrument::grip() const
{
    const Impl::Snapshot now = impl_->newest.read();
    return transform(now.pose, now.gripAt);
}
void ArticulatedInstrument::carries(Vec3 at)
{
    impl_->act([at](Impl& impl) {
        impl.carried = at;
        if (!impl.grip) impl.gripAt = at;
    });
}
double ArticulatedInstrument::opening() const { return impl_->newest.read().widest; }
InstrumentKind ArticulatedInstrument::kind() const { return impl_->def.kind; }

} // namespace filasofia::prefab
