#include "filasofia/sofa/scene_state.h"

#include "filasofia/sofa/make_tie.h"
#include "filasofia/sofa/replace_body.h"
#include "filasofia/sofa/sofa_process.h"

#include <algorithm>
#include <utility>

namespace filasofia::sofaengine {
namespace {

void addTo(Hasher& hash, const SoftSettings& body)
{
    for (const PinGroup& group : body.pins) {
        hash.add(std::uint64_t{group.id.value});
        hash.add(group.stiffness);
        hash.addAll(std::span<const int>(group.nodes));
        hash.addAll(std::span<const Vec3>(group.places));
    }
    for (const physics::NodalForce& each : body.forces) {
        hash.add(static_cast<std::uint64_t>(each.node));
        hash.addAll(std::span<const Vec3>(&each.force, 1));
    }
    hash.add(body.pressure);
    if (body.cut) hash.add(body.cut->cuts.history);
}

void addTo(Hasher& hash, const MotionState& hand)
{
    hash.addAll(std::span<const Pose>(&hand.pose, 1));
    const Vec3 both[] = {hand.velocity, hand.angularVelocity};
    hash.addAll(std::span<const Vec3>(both));
}

} // namespace

void addTo(Hasher& hash, const RigidSettings& body, bool drive)
{
    hash.add(static_cast<std::uint64_t>(body.cutting ? 1 : 0));
    hash.add(static_cast<std::uint64_t>(body.sheath));
    for (const engine::Wrench& each : body.wrenches) {
        const Vec3 both[] = {each.force, each.torque};
        hash.addAll(std::span<const Vec3>(both));
    }
    for (std::size_t i = 0; i < body.hands.size(); ++i) {
        if (!body.hands[i]) continue;
        hash.add(std::uint64_t{i});
        addTo(hash, body.hands[i]->target);
        const VirtualCoupling& c = body.hands[i]->coupling;
        for (const double each :
             {c.linearStiffness, c.linearDamping, c.angularStiffness, c.angularDamping, c.forceLimit, c.torqueLimit})
            hash.add(each);
    }
    for (std::size_t j = 0; j < body.joints.commands.size(); ++j) {
        hash.add(static_cast<std::uint64_t>(body.joints.commands[j].index()));
        hash.add(std::visit([](const auto& each) { return each.value; }, body.joints.commands[j]));
        // A joint that a force drives moves by itself: that drives nothing.
        if (!drive || std::holds_alternative<physics::JointPosition>(body.joints.commands[j]))
            hash.add(body.joints.joints[j].position);
        if (!drive) hash.add(body.joints.joints[j].velocity);
    }
    for (const auto& target : body.targets)
        if (target) hash.addAll(std::span<const Pose>(&*target, 1));
}

SceneMotion motionOf(const SofaScene& scene)
{
    SceneMotion motion;
    for (const auto& body : scene.soft) body->read(motion.soft.emplace_back());
    for (const auto& body : scene.rigid) body->read(motion.rigid.emplace_back());
    return motion;
}

bool isUsable(const SofaScene& scene)
{
    const auto usable = [](const auto& body) { return body->isUsable(); };
    return std::ranges::all_of(scene.soft, usable) && std::ranges::all_of(scene.rigid, usable);
}

SceneState stateOf(const SofaScene& scene)
{
    SceneState state{.gravity = fromSofa(scene.root->getGravity()),
                     .motion = motionOf(scene),
                     .grasps = scene.grasps,
                     .contacts = scene.contacts};
    for (const auto& body : scene.soft) state.soft.push_back(body->settings());
    for (const auto& body : scene.rigid) state.rigid.push_back(body->settings());
    for (const auto& tie : scene.ties) state.ties.push_back(tie->state());
    return state;
}

namespace {

bool isSameMesh(const SoftSettings& settings, const SoftNode& body)
{
    return !settings.cut ||
           (settings.cut->cuts.history == body.cuts()->history && settings.cut->cuts.revision == body.cuts()->revision);
}

/// Gives bodies the meshes of a state; ties that hold those that are made anew are gone.
void setMeshes(const SceneState& state, SofaScene& scene)
{
    for (std::size_t b = 0; b < scene.soft.size(); ++b) {
        const SoftSettings& settings = state.soft[b];
        if (!settings.cut) continue;
        if (isSameMesh(settings, *scene.soft[b]))
            *scene.soft[b]->cuts() = settings.cut->cuts;
        else
            replaceBody({.plan = settings.cut->plan, .state = state.motion.soft[b], .settings = settings},
                        std::make_unique<SoftCuts>(settings.cut->cuts), scene, scene.soft[b]->id());
    }
}

void setBodies(const SceneState& state, SofaScene& scene)
{
    const auto isCoupled = [](const SoftSettings& each) { return each.coupled; };
    if (!state.ties.empty() || std::ranges::any_of(state.soft, isCoupled)) startConstraints(scene);
    std::vector<std::unique_ptr<Tie>> ties; // beside the old ones: this is what may fail
    for (const TieState& each : state.ties) ties.push_back(makeTie(each, scene));
    scene.ties = std::move(ties);
    scene.contact.forget();
    scene.contact.join({});
    scene.root->setGravity(toSofa(state.gravity));
    for (std::size_t b = 0; b < scene.soft.size(); ++b) {
        scene.soft[b]->apply(state.soft[b]);
        scene.soft[b]->write(state.motion.soft[b]);
    }
    for (std::size_t b = 0; b < scene.rigid.size(); ++b) {
        scene.rigid[b]->apply(state.rigid[b]);
        scene.rigid[b]->write(state.motion.rigid[b]);
    }
    scene.grasps = state.grasps;
    scene.contacts = state.contacts;
}

} // namespace

void setState(const SceneState& state, SofaScene& scene)
{
    bool same = true;
    for (std::size_t b = 0; b < scene.soft.size(); ++b) same = same && isSameMesh(state.soft[b], *scene.soft[b]);
    if (same) {
        setBodies(state, scene);
        setMeshes(state, scene);
        return;
    }
    const SceneState before = stateOf(scene);
    try {
        setMeshes(state, scene);
        setBodies(state, scene);
    } catch (...) {
        attempt("restore", [&] {
            setMeshes(before, scene);
            setBodies(before, scene);
        });
        throw;
    }
}

void addTo(Hasher& hash, const SceneState& state)
{
    hash.addAll(std::span<const Vec3>(&state.gravity, 1));
    for (const SoftState& body : state.motion.soft) {
        hash.addAll(std::span<const Vec3>(body.positions));
        hash.addAll(std::span<const Vec3>(body.velocities));
    }
    for (const RigidState& body : state.motion.rigid) {
        hash.addAll(std::span<const Pose>(body.poses));
        hash.addAll(std::span<const Vec3>(body.velocities));
        hash.addAll(std::span<const Vec3>(body.angularVelocities));
    }
    for (const SoftSettings& each : state.soft) addTo(hash, each);
    for (const RigidSettings& each : state.rigid) addTo(hash, each, false);
    for (const TieState& each : state.ties) addTo(hash, each);
    for (const physics::Grasp& each : state.grasps)
        for (const std::uint32_t id : {each.id.value, each.rigid.value, each.target.value}) hash.add(std::uint64_t{id});
}

void resetScene(SofaScene& scene)
{
    scene.contacts.clear();
    scene.contact.forget();
    std::erase_if(scene.ties, [](const auto& each) { return each->isBroken(); });
    for (std::size_t b = 0; b < scene.soft.size(); ++b)
        if (scene.soft[b]->cuts()) mendBody(scene.soft[b]->id(), scene);
    for (const auto& body : scene.soft) {
        const std::vector<Vec3>& rest = body->plan().mesh.nodes;
        body->write({rest, std::vector<Vec3>(rest.size())});
    }
    for (const auto& body : scene.rigid) body->rewind();
    for (const auto& tie : scene.ties) tie->rewind();
}

} // namespace filasofia::sofaengine
