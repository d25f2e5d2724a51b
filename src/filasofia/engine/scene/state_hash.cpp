#include "filasofia/engine/scene/state_hash.h"

#include "filasofia/core/hash.h"

#include <algorithm>
#include <span>
#include <variant>

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

// An empty list does not change the hash.
void addCount(Hasher& hash, std::size_t count)
{
    if (count > 0) hash.add(static_cast<std::uint64_t>(count));
}

void add(Hasher& hash, const SurfaceName& name)
{
    hash.add(std::uint64_t{name.body.value});
    hash.add(static_cast<std::uint64_t>(name.model));
}

void addCouplings(Hasher& hash, const RigidState& body)
{
    addCount(hash, body.couplings.size());
    for (const ElementCoupling& hand : body.couplings) {
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

// A body without cavities does not change the hash.
void addCavities(Hasher& hash, const SoftState& body)
{
    for (const CavityState& cavity : body.cavities)
        for (double each : {cavity.content, cavity.pressure, cavity.inflow, cavity.last, cavity.lost}) hash.add(each);
}

void addContacts(Hasher& hash, const Scene& scene)
{
    addCount(hash, scene.contacts.size());
    for (const CachedContact& contact : scene.contacts) {
        for (BodyId body : {contact.first, contact.second}) hash.add(std::uint64_t{body.value});
        hash.add(contact.feature);
        add(hash, contact.point);
        add(hash, contact.force);
        if (contact.frictionLags) addCount(hash, 1); // a contact whose friction does not lag adds nothing
    }
    addCount(hash, scene.sides.size());
    for (const SheetSide& kept : scene.sides) {
        add(hash, kept.source);
        add(hash, kept.target);
        for (int each : {kept.point, kept.feature[0], kept.feature[1], kept.feature[2], kept.side})
            hash.add(static_cast<std::uint64_t>(each));
    }
}

void add(Hasher& hash, const std::vector<NodeWeight>& point)
{
    for (const NodeWeight& each : point) {
        hash.add(static_cast<std::uint64_t>(each.node));
        hash.add(each.weight);
    }
}

// A body without clips does not change the hash.
void addClips(Hasher& hash, const SoftState& body)
{
    for (const Clip& clip : body.clips) {
        for (std::uint32_t id : {clip.id.value, clip.clip.value}) hash.add(std::uint64_t{id});
        for (double each : {clip.gap, clip.age, clip.force}) hash.add(each);
        const physics::ClipDef& def = clip.def;
        hash.add(static_cast<std::uint64_t>(def.element));
        for (double each : {def.length, def.width, def.opening, def.gap, def.closingTime, def.closingForce,
                            def.stiffness, def.friction})
            hash.add(each);
        addCount(hash, clip.pairs.size());
        for (const ClipPair& pair : clip.pairs)
            for (const auto& side : pair) add(hash, side);
        for (std::size_t corner : clip.corners) hash.add(static_cast<std::uint64_t>(corner));
        hash.add(std::uint64_t{clip.partial});
    }
}

// How far clips are closed: what they press follows from it, and from where the tissue is.
void addGaps(Hasher& hash, const SoftState& body)
{
    for (const Clip& clip : body.clips) {
        hash.add(std::uint64_t{clip.id.value});
        hash.add(clip.gap);
    }
}

void add(Hasher& hash, const AttachedPoint& point)
{
    add(hash, point.nodes);
    hash.add(static_cast<std::uint64_t>(point.element));
    add(hash, point.place);
}

void add(Hasher& hash, const physics::Mouth& mouth)
{
    hash.add(static_cast<std::uint64_t>(mouth.element));
    for (const Vec3& each : {mouth.pivot, mouth.forward, mouth.opens}) add(hash, each);
    hash.add(mouth.length);
}

void addAttachments(Hasher& hash, const Scene& scene)
{
    addCount(hash, scene.attachments.size());
    for (const Attachment& each : scene.attachments) {
        for (std::uint32_t id : {each.id.value, each.body.value, each.to.value}) hash.add(std::uint64_t{id});
        hash.add(each.stiffness);
        hash.add(each.breakForce);
        if (each.pointBreakForce != physics::kNever || each.cutDistance != 0.0) { // the hash of others stays
            hash.add(each.pointBreakForce);
            hash.add(each.cutDistance);
        }
        for (const auto& pair : each.pairs)
            for (const AttachedPoint& point : pair) add(hash, point);
        for (const AttachedTurn& turn : each.turns) {
            hash.add(static_cast<std::uint64_t>(turn.edge));
            hash.add(static_cast<std::uint64_t>(turn.element));
            add(hash, turn.director);
        }
    }
    for (const std::vector<Vec3>& attachment : scene.attachmentForces)
        for (const Vec3& force : attachment) add(hash, force);
    addCount(hash, scene.grasps.size());
    for (const PendingGrasp& each : scene.grasps) {
        for (std::uint32_t id : {each.id.value, each.rigid.value, each.target.value}) hash.add(std::uint64_t{id});
        hash.add(each.stiffness);
        hash.add(each.breakForce);
        if (each.mouth) add(hash, *each.mouth); // the hash of others stays
    }
}

// A scene without channels does not change the hash.
void addChannels(Hasher& hash, const Scene& scene)
{
    for (const Channel& each : scene.channels) {
        hash.add(std::uint64_t{each.tissue.value});
        hash.add(each.spacing);
        addCount(hash, each.lines.size());
        for (const ThreadedLine& line : each.lines) {
            hash.add(std::uint64_t{line.body.value});
            hash.add(static_cast<std::uint64_t>(line.reversed));
            hash.add(line.start);
            addCount(hash, line.first);
        }
        addCount(hash, each.points.size());
        for (const ChannelPoint& point : each.points) {
            add(hash, point.nodes);
            hash.add(point.before);
            hash.add(point.held);
            hash.add(static_cast<std::uint64_t>(point.slides));
            hash.add(point.pressed);
        }
        add(hash, each.end);
        hash.add(each.travelled);
        hash.add(static_cast<std::uint64_t>(each.through));
    }
}

void add(Hasher& hash, const physics::JointCommand& command)
{
    hash.add(static_cast<std::uint64_t>(command.index()));
    hash.add(std::visit([](const auto& each) { return each.value; }, command));
    if (const auto* spring = std::get_if<physics::JointSpring>(&command))
        for (const double each : {spring->stiffness, spring->damping, spring->strength}) hash.add(each);
}

void add(Hasher& hash, const Wrench& wrench)
{
    add(hash, wrench.force);
    add(hash, wrench.torque);
}

void addJoints(Hasher& hash, const RigidState& body)
{
    for (const JointState& joint : body.joints) {
        add(hash, joint.command);
        for (double each : {joint.now.position, joint.now.velocity, joint.now.force, joint.now.load, joint.now.stop,
                            joint.lowerLimitForce, joint.upperLimitForce, joint.frictionForce})
            hash.add(each);
    }
}

// A body that is no rod does not change the hash.
void add(Hasher& hash, const RodState& rod)
{
    for (Vec3 each : rod.directors) add(hash, each);
    for (const auto* list : {&rod.spins, &rod.twists, &rod.tensions})
        for (double each : *list) hash.add(each);
    for (const RodSteering& each : rod.steering)
        for (double axis : each.now) hash.add(axis);
    for (const RodCurvature& each : rod.plastic)
        for (const auto& edge : each)
            for (double axis : edge) hash.add(axis);
}

/// Adds the edits of a mesh. A mesh without edits does not change the hash.
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

} // namespace

std::uint64_t hashOf(const Scene& scene)
{
    Hasher hash;
    hash.add(scene.step);
    hash.add(scene.time);
    add(hash, scene.gravity);
    for (const SoftBody& body : scene.soft) {
        hash.addAll(std::span<const Vec3>(body.state.x));
        hash.addAll(std::span<const Vec3>(body.state.v));
        hash.add(body.state.pressure);
        addCavities(hash, body.state);
        addClips(hash, body.state);
        add(hash, body.state.rod);
    }
    for (const SoftBody& body : scene.soft) add(hash, body.topology, body.model);
    for (const RigidBody& each : scene.rigid) {
        const RigidState& body = each.state;
        for (const Pose& pose : body.poses) add(hash, pose);
        addJoints(hash, body);
        if (!body.cutting) hash.add(std::uint64_t{1}); // the hash of others stays
        if (body.sheath > 0) hash.add(static_cast<std::uint64_t>(body.sheath));
        if (!each.model.dynamic && body.joints.empty()) continue; // a kinematic body is its poses alone
        for (const auto* list : {&body.velocities, &body.angularVelocities})
            for (const Vec3& v : *list) add(hash, v);
        for (const Wrench& wrench : body.wrenches) add(hash, wrench);
        addCouplings(hash, body);
    }
    addContacts(hash, scene);
    addAttachments(hash, scene);
    addChannels(hash, scene);
    return hash.value();
}

std::uint64_t hashOfDrive(const Scene& scene)
{
    Hasher hash;
    add(hash, scene.gravity);
    for (const SoftBody& body : scene.soft) {
        if (std::ranges::any_of(body.state.forces, [](Vec3 f) { return f != Vec3{}; }))
            hash.addAll(std::span<const Vec3>(body.state.forces));
        hash.add(body.state.pressure);
        addCavities(hash, body.state); // what leaks moves the wall
        addGaps(hash, body.state);     // as do clips that close
        for (const RodSteering& each : body.state.rod.steering)
            for (double axis : {each.now[0], each.now[1], each.target[0], each.target[1]}) hash.add(axis);
    }
    for (const RigidBody& body : scene.rigid) {
        if (!body.model.dynamic)
            for (const Pose& pose : body.state.poses) add(hash, pose);
        for (const JointState& joint : body.state.joints) add(hash, joint.command);
        for (const Wrench& wrench : body.state.wrenches) add(hash, wrench);
        addCouplings(hash, body.state);
    }
    return hash.value();
}

} // namespace filasofia::engine
