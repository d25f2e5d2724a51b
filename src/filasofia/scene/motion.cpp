#include "filasofia/scene/motion.h"

#include "filasofia/core/error.h"
#include "filasofia/scene/remember_past.h"

#include <algorithm>
#include <cmath>

namespace filasofia::scene {
namespace {

/// The time within a motion that may repeat.
template <class Motion> double within(const Motion& motion, double time)
{
    return motion.repeat ? std::fmod(time, motion.keys.back().time) : time;
}

/// The first key that is later than `time`.
template <class Keys> auto laterKey(const Keys& keys, double time)
{
    return std::ranges::upper_bound(keys, time, {}, [](const auto& key) { return key.time; });
}

template <class Motion> void checkKeys(const Motion& motion, const std::string& name)
{
    for (std::size_t i = 0; i < motion.keys.size(); ++i)
        if constexpr (requires { motion.keys[i].pose; })
            (void)physics::unitPose(motion.keys[i].pose, text(name, ".keys[", i, "].pose"));
    checkTimes(motion.keys, name + ".keys");
    if (motion.repeat && !(motion.keys.back().time > 0.0)) fail(name, ".repeat needs a last key later than 0 s");
}

/// Refuses a second motion of the same element or joint.
template <class Motion>
void checkOnce(const std::vector<Motion>& motions, std::size_t i, int Motion::*index, const std::string& name)
{
    for (std::size_t before = 0; before < i; ++before)
        if (motions[before].*index == motions[i].*index)
            fail(name, " moves what motions[", before, "] moves: number ", motions[i].*index);
}

/// Gives each joint of a body its next command as soon as its time has come.
class JointFollower {
public:
    JointFollower(BodyId id, std::vector<JointMotion> motions)
        : id_(id), motions_(std::move(motions)), given_(motions_.size(), kNone)
    {
    }

    void give(physics::PhysicsServer& server, double time)
    {
        if (!server.has(id_)) return; // removed: its motions have ended
        for (std::size_t i = 0; i < motions_.size(); ++i) {
            const std::size_t key = keyAt(motions_[i], time);
            if (key == kNone || key == given_[i]) continue;
            server.setJoint(id_, motions_[i].joint, motions_[i].keys[key].command);
            given_[i] = key;
        }
    }

    [[nodiscard]] const std::vector<std::size_t>& past() const { return given_; }
    void goBack(const std::vector<std::size_t>& given) { given_ = given; }

private:
    static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

    /// The key whose command holds at this time.
    [[nodiscard]] static std::size_t keyAt(const JointMotion& motion, double time)
    {
        const auto later = laterKey(motion.keys, within(motion, time));
        if (later != motion.keys.begin()) return static_cast<std::size_t>(later - motion.keys.begin()) - 1;
        // In a motion that repeats, the last command holds until the first key of the next round.
        const bool again = motion.repeat && time >= motion.keys.back().time;
        return again ? motion.keys.size() - 1 : kNone;
    }

    BodyId id_;
    std::vector<JointMotion> motions_;
    std::vector<std::size_t> given_; ///< the last key of each
};

} // namespace

ElementMotion withFirstKey(ElementMotion motion, const Pose& start)
{
    if (motion.keys.front().time > 0.0) motion.keys.insert(motion.keys.begin(), {0.0, start});
    return motion;
}

Pose poseAt(const ElementMotion& motion, double time)
{
    const auto later = laterKey(motion.keys, within(motion, time));
    if (later == motion.keys.begin()) return motion.keys.front().pose;
    const auto before = later - 1;
    // A key is reached exactly: a scene that was saved from a recording has one for every step.
    if (later == motion.keys.end() || within(motion, time) == before->time) return before->pose;
    return between(before->pose, later->pose, (within(motion, time) - before->time) / (later->time - before->time));
}

physics::HapticTarget handAt(const ElementMotion& motion, double time)
{
    constexpr double earlier = 1e-3; // [s]
    const Pose now = poseAt(motion, time), before = poseAt(motion, std::max(0.0, time - earlier));
    const Vec3 turn = rotationVector(now.orientation * conjugate(before.orientation));
    return {.pose = now,
            .velocity = 1.0 / earlier * (now.position - before.position),
            .angularVelocity = 1.0 / earlier * turn,
            .coupling = motion.hand.value_or(VirtualCoupling{})};
}

void checkMotions(const SceneBody& body)
{
    if (body.motions.empty() && body.jointMotions.empty()) return;
    const auto* rigid = std::get_if<physics::RigidBodyDef>(&body.def);
    if (!rigid) fail(physics::describeBody(body.def), ": motions must be empty: only rigid bodies have them");
    const std::string object = physics::describeBody(body.def);
    const std::size_t joints = rigid->articulation.joints.size();
    const std::size_t movable = joints > 0 ? 1 : physics::elementCount(*rigid);
    for (std::size_t i = 0; i < body.motions.size(); ++i) {
        const std::string name = text(object, ": motions[", i, "]");
        const ElementMotion& motion = body.motions[i];
        if (rigid->dynamic && !motion.hand) fail(name, " moves a dynamic body, which only forces move; give it a hand");
        if (!rigid->dynamic && motion.hand) fail(name, ".hand needs a dynamic body; this one is kinematic");
        if (motion.element < 0 || static_cast<std::size_t>(motion.element) >= movable)
            fail(name, ".element must be in [0, ", movable, "), got ", motion.element);
        checkOnce(body.motions, i, &ElementMotion::element, name);
        checkKeys(motion, name);
    }
    for (std::size_t i = 0; i < body.jointMotions.size(); ++i) {
        const std::string name = text(object, ": jointMotions[", i, "]");
        const JointMotion& motion = body.jointMotions[i];
        if (joints == 0) fail(name, " needs a body with an articulation");
        if (motion.joint < 0 || static_cast<std::size_t>(motion.joint) >= joints)
            fail(name, ".joint must be in [0, ", joints, "), got ", motion.joint);
        if (const auto& mimic = rigid->articulation.joints[static_cast<std::size_t>(motion.joint)].mimic)
            fail(name, ".joint must take commands, got ", motion.joint, ", which mimics joint ", mimic->joint);
        checkOnce(body.jointMotions, i, &JointMotion::joint, name);
        checkKeys(motion, name);
    }
}

void setFirstPoses(const std::vector<ElementMotion>& motions, physics::RigidBodyDef& body)
{
    for (const ElementMotion& motion : motions)
        if (const KeyPose& first = motion.keys.front(); first.time == 0.0)
            body.elements.at(static_cast<std::size_t>(motion.element)) = first.pose;
}

void followMotions(runtime::Simulation& simulation, BodyId id, const SceneBody& body)
{
    if (!body.motions.empty()) {
        std::vector<ElementMotion> motions;
        const std::vector<Pose> start = physics::elementPoses(std::get<physics::RigidBodyDef>(body.def));
        for (const ElementMotion& each : body.motions)
            motions.push_back(withFirstKey(each, start.at(static_cast<std::size_t>(each.element))));
        simulation.everyStep([&simulation, id, motions](double time) {
            if (!simulation.physics().has(id)) return; // removed: its motions have ended
            for (const ElementMotion& each : motions)
                if (each.hand)
                    simulation.physics().setHaptic(id, handAt(each, time), each.element);
                else
                    simulation.physics().setPose(id, poseAt(each, time), each.element);
        });
    }
    if (body.jointMotions.empty()) return;
    const auto joints = std::make_shared<JointFollower>(id, body.jointMotions);
    simulation.everyStep([&simulation, joints](double time) { joints->give(simulation.physics(), time); });
    rememberPast(simulation, text("the joint motions of ", physics::describeBody(body.def)), joints);
}

} // namespace filasofia::scene
