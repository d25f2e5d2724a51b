#include "filasofia/engine/world.h"

#include "filasofia/core/hash.h"
#include "filasofia/engine/build/build_body.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

void add(Hasher& hash, Vec3 v)
{
    hash.add(v.x);
    hash.add(v.y);
    hash.add(v.z);
}

void add(Hasher& hash, const Pose& pose)
{
    add(hash, pose.position);
    hash.add(pose.orientation.w);
    add(hash, Vec3{pose.orientation.x, pose.orientation.y, pose.orientation.z});
}

// What a state does not have leaves its hash as it was.
void addCount(Hasher& hash, std::size_t count)
{
    if (count > 0) hash.add(static_cast<std::uint64_t>(count));
}

void add(Hasher& hash, const SurfaceName& name)
{
    hash.add(std::uint64_t{name.body.value});
    hash.add(static_cast<std::uint64_t>(name.model));
}

void addHands(Hasher& hash, const RigidState& body)
{
    addCount(hash, body.hands.size());
    for (const Hand& hand : body.hands) {
        hash.add(static_cast<std::uint64_t>(hand.element));
        add(hash, hand.target.pose);
        add(hash, hand.target.velocity);
        add(hash, hand.target.angularVelocity);
        const auto& c = hand.target.coupling;
        for (double each :
             {c.linearStiffness, c.linearDamping, c.angularStiffness, c.angularDamping, c.forceLimit, c.torqueLimit})
            hash.add(each);
    }
}

void addContacts(Hasher& hash, const State& state)
{
    addCount(hash, state.contacts.size());
    for (const ContactMemory& contact : state.contacts) {
        for (BodyId body : {contact.first, contact.second}) hash.add(std::uint64_t{body.value});
        hash.add(contact.feature);
        add(hash, contact.point);
        add(hash, contact.force);
    }
    addCount(hash, state.sides.size());
    for (const SideKept& kept : state.sides) {
        add(hash, kept.source);
        add(hash, kept.target);
        for (int each : {kept.point, kept.feature[0], kept.feature[1], kept.feature[2], kept.side})
            hash.add(static_cast<std::uint64_t>(each));
    }
}

void add(Hasher& hash, const AttachedPoint& point)
{
    for (const NodeWeight& each : point.nodes) {
        hash.add(static_cast<std::uint64_t>(each.node));
        hash.add(each.weight);
    }
    hash.add(static_cast<std::uint64_t>(point.element));
    add(hash, point.place);
}

void addAttachments(Hasher& hash, const State& state)
{
    addCount(hash, state.attachments.size());
    for (const Attachment& each : state.attachments) {
        for (std::uint32_t id : {each.id.value, each.body.value, each.to.value}) hash.add(std::uint64_t{id});
        hash.add(each.stiffness);
        hash.add(each.breakForce);
        for (const auto& pair : each.pairs)
            for (const AttachedPoint& point : pair) add(hash, point);
    }
    for (const std::vector<Vec3>& attachment : state.holding)
        for (const Vec3& force : attachment) add(hash, force);
    addCount(hash, state.grasps.size());
    for (const PendingGrasp& each : state.grasps) {
        for (std::uint32_t id : {each.id.value, each.rigid.value, each.target.value}) hash.add(std::uint64_t{id});
        hash.add(each.stiffness);
        hash.add(each.breakForce);
    }
}

void addJoints(Hasher& hash, const RigidState& body)
{
    for (const JointState& joint : body.joints) {
        hash.add(static_cast<std::uint64_t>(joint.command.index()));
        hash.add(std::visit([](const auto& command) { return command.value; }, joint.command));
        for (double each : {joint.now.position, joint.now.velocity, joint.now.force, joint.now.load, joint.now.stop,
                            joint.lowerStop, joint.upperStop, joint.dry})
            hash.add(each);
    }
}

/// A mesh that was edited; one that was not leaves the hash as it was.
void add(Hasher& hash, const BodyTopology& topology, const SoftModel& model)
{
    if (topology.revision == 0) return;
    hash.add(topology.revision);
    hash.add(topology.history);
    for (int piece : model.removed) hash.add(static_cast<std::uint64_t>(piece));
    for (const Stroke& stroke : topology.strokes) {
        hash.add(std::uint64_t{stroke.tool.value});
        hash.add(static_cast<std::uint64_t>(stroke.stroke.sheet()));
        hash.add(stroke.sinceCrossing);
    }
}

/// Times the stages of a step with the clock that the step was given.
class StopWatch {
public:
    explicit StopWatch(const physics::StepBudget* budget) : now_(budget && budget->now ? &budget->now : nullptr)
    {
        if (now_) last_ = (*now_)();
    }
    /// [s] since the last lap; 0 without a clock.
    double lap()
    {
        if (!now_) return 0.0;
        const std::int64_t before = std::exchange(last_, (*now_)());
        return 1e-9 * static_cast<double>(last_ - before);
    }

private:
    const std::function<std::int64_t()>* now_;
    std::int64_t last_ = 0;
};

} // namespace

World::World(const NativeEngineDef& def)
    : period_(def.period), contact_(def.contact),
      pool_(std::make_unique<WorkerPool>(def.threads.value_or(std::clamp(usableCores() - 1, 1, 8)))),
      background_(std::make_unique<BackgroundThread>())
{
}

std::unique_ptr<physics::BuiltBody> World::build(const physics::BodyDef& def) const { return buildBody(def, period_); }

physics::StepReport World::step(const physics::StepInput& in)
{
    physics::StepReport report{.dt = in.dt, .flags = in.flags};
    StopWatch watch(in.budget);
    applyCommands(in.commands, *this, model_, state_, systems_, ruptures_.topologies,
                  report);                    // 1 what the outside asked for
    remakeSystems(model_, period_, systems_); //   of what it changed
    report.times.commands = watch.lap();
    findContacts(model_, in.dt, contact_, state_, coupling_, *pool_); // 2 who touches whom
    linkAttachments(in.dt, model_, state_, coupling_, report);        //   who holds whom
    linkJoints(model_, in.dt, state_, coupling_);                     //   what holds joints
    report.times.contacts = watch.lap();
    assemble(model_, in.dt, state_, systems_, *pool_); // 3 forces and stiffness
    report.times.assemble = watch.lap();
    advance(model_, in.dt, in.budget, contact_, systems_, coupling_, state_, *pool_,
            report);                                // 4 new velocities, places
    keepContacts(in.dt, coupling_, state_, report); // what they did to each other
    keepAttachments(in.dt, coupling_, systems_, model_, state_);
    keepJoints(model_, in.dt, coupling_, state_);
    report.times.advance = watch.lap();
    cutBodies(model_, in.dt, coupling_.rigid, state_, ruptures_, report);   // 5 what was cut
    applyEdits(period_, model_, state_, systems_, ruptures_, report);       // 6 the only writer of topology
    tearBodies(model_, in.dt, state_, systems_, ruptures_, *pool_, report); //   what tore
    applyEdits(period_, model_, state_, systems_, ruptures_, report);
    removeLostPieces(model_, state_, systems_, ruptures_.topologies, report);
    followPartings(model_, in.dt, systems_, *background_);
    report.times.topology = watch.lap();
    return report;
}

void World::capture(frame::Frame& out) const
{
    out.step = state_.step;
    out.time = state_.time;
    out.softBodies.resize(model_.softBodies.size());
    for (std::size_t b = 0; b < model_.softBodies.size(); ++b) {
        out.softBodies[b].id = model_.softBodies[b].id;
        out.softBodies[b].positions = state_.softBodies[b].x;
        out.softBodies[b].velocities = state_.softBodies[b].v;
        out.softBodies[b].boundary = boundaryOf(model_.softBodies[b], ruptures_.topologies[b]);
    }
    out.contacts = state_.touching;
    out.attachments = state_.held;
    out.rigidBodies.resize(model_.rigidBodies.size());
    for (std::size_t b = 0; b < model_.rigidBodies.size(); ++b) {
        out.rigidBodies[b].id = model_.rigidBodies[b].id;
        out.rigidBodies[b].poses = state_.rigidBodies[b].poses;
        out.rigidBodies[b].velocities = state_.rigidBodies[b].velocities;
        out.rigidBodies[b].angularVelocities = state_.rigidBodies[b].angularVelocities;
        out.rigidBodies[b].joints.clear();
        for (const JointState& joint : state_.rigidBodies[b].joints) out.rigidBodies[b].joints.push_back(joint.now);
    }
}

void World::record(physics::StepRecord& out) const
{
    out.rigidPoses.clear();
    for (const RigidState& body : state_.rigidBodies)
        out.rigidPoses.insert(out.rigidPoses.end(), body.poses.begin(), body.poses.end());
    out.contacts = state_.touching;
    out.attachments = state_.held;
}

std::uint64_t World::hash() const
{
    Hasher hash;
    hash.add(state_.step);
    hash.add(state_.time);
    add(hash, state_.gravity);
    for (const SoftState& body : state_.softBodies) {
        hash.addAll(std::span<const Vec3>(body.x));
        hash.addAll(std::span<const Vec3>(body.v));
        hash.add(body.pressure);
    }
    for (std::size_t b = 0; b < model_.softBodies.size(); ++b) add(hash, ruptures_.topologies[b], model_.softBodies[b]);
    for (std::size_t b = 0; b < model_.rigidBodies.size(); ++b) {
        const RigidState& body = state_.rigidBodies[b];
        for (const Pose& pose : body.poses) add(hash, pose);
        addJoints(hash, body);
        if (!model_.rigidBodies[b].dynamic && body.joints.empty())
            continue; // between steps it is its poses, and no more
        for (const auto* list : {&body.velocities, &body.angularVelocities})
            for (const Vec3& v : *list) add(hash, v);
        for (const Wrench& wrench : body.wrenches) {
            add(hash, wrench.force);
            add(hash, wrench.torque);
        }
        addHands(hash, body);
    }
    addContacts(hash, state_);
    addAttachments(hash, state_);
    return hash.value();
}

} // namespace filasofia::engine
