#include "filasofia/engine/body/rigid_model.h"

#include "filasofia/core/validate.h"
#include "filasofia/engine/body/check_collision.h"
#include "filasofia/engine/body/check_size.h"
#include "filasofia/engine/body/usable.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::engine {
namespace {

using physics::RigidInertia;

void checkPose(const std::string& object, const Pose& pose)
{
    if (!isFinite(pose)) fail(object, ": poses must be finite");
    if (std::abs(dot(pose.orientation, pose.orientation) - 1.0) > 1e-6)
        fail(object, ": orientation must be a unit quaternion");
}

/// Checks that a step can divide by mass and inertia, and that a physical body can have this inertia.
void checkInertia(const std::string& object, const RigidInertia& body)
{
    if (!(body.mass > 0.0 && std::isfinite(body.mass) && std::isfinite(1.0 / body.mass)))
        fail(object, ".mass must be > 0 kg, got ", body.mass);
    if (!usable({&body.centre, 1}))
        fail(object, ".centre must lie within ", physics::kFarthest, " m of the element's origin");
    const Mat3& j = body.inertia;
    const double size = trace(j) / 3.0;
    if (!(size > 0.0 && std::isfinite(size) && std::isfinite(1.0 / size)))
        fail(object, ".inertia must be > 0 kg m^2, got ", size, " in the mean");
    constexpr double rounding = 1e-9;
    if (!(frobeniusNorm(j - transpose(j)) < rounding * size)) fail(object, ".inertia must be symmetric");
    // Sylvester's criterion for the inertia and, with a tolerance for rounding, for its second moments of mass.
    constexpr double tolerance = 1e-12;
    const Mat3 one = (1.0 / size) * j, second = (1.5 + rounding) * Mat3::identity() - one;
    const auto smallestMinor = [](const Mat3& m) {
        return std::min({m[0].x, m[0].x * m[1].y - m[0].y * m[1].x, determinant(m)});
    };
    if (!(smallestMinor(one) > tolerance))
        fail(object, ".inertia must be > 0 about every axis, and about none of them negligible");
    if (!(smallestMinor(second) > -tolerance))
        fail(object, ".inertia: no moment may be more than the sum of the other two");
}

void checkJoints(const std::string& object, const RigidModel& model, const RigidState& state)
{
    const ArticulationModel& articulation = model.articulation;
    const std::size_t joints = articulation.tree.joints.size();
    checkSize(object, "commands of joints", articulation.commands.size(), joints);
    checkSize(object, "joints", state.joints.size(), joints);
    if (joints == 0) return;
    checkSize(object, "elements", model.rest.size(), joints + 1);
    checkTree(object, articulation.tree);
    if (model.dynamic && articulation.to) fail(object, ": a dynamic body cannot be carried by another");
    for (std::size_t j = 0; j < joints; ++j) {
        const LinkJoint& joint = articulation.tree.joints[j];
        const std::string field = text(object, ": joints[", j, "]");
        const physics::RigidInertia& link = model.inertias[static_cast<std::size_t>(joint.child)];
        if (link.mass != 0.0) checkInertia(field + ": link", link);
        for (const physics::JointCommand& command : {state.joints[j].command, articulation.commands[j]}) {
            const bool force = physics::isByForce(command);
            if (!std::isfinite(std::visit([](const auto& each) { return each.value; }, command)))
                fail(field, ".command must be finite");
            if (const auto* spring = std::get_if<physics::JointSpring>(&command))
                if (!(spring->stiffness >= 0.0 && std::isfinite(spring->stiffness) && spring->damping >= 0.0 &&
                      std::isfinite(spring->damping) && spring->strength >= 0.0))
                    fail(field, ".command must have a stiffness, a damping and a strength >= 0");
            if (force && !(joint.inertia > 0.0 || link.mass > 0.0))
                fail(field, ".command: a force needs a link with mass or a joint with inertia");
        }
        const frame::Joint& now = state.joints[j].now;
        if (!(now.position >= joint.lower && now.position <= joint.upper && std::isfinite(now.position)))
            fail(field, ".position must be within its limits, got ", now.position);
        for (double each : {now.velocity, now.force, now.load, now.stop, state.joints[j].lowerLimitForce,
                            state.joints[j].upperLimitForce, state.joints[j].frictionForce})
            if (!std::isfinite(each)) fail(field, " must be finite");
    }
}

void checkCouplings(const std::string& object, const RigidModel& model, const RigidState& state)
{
    if (!model.dynamic && !state.couplings.empty()) fail(object, ": only a dynamic body can have virtual couplings");
    for (std::size_t h = 0; h < state.couplings.size(); ++h) {
        const ElementCoupling& hand = state.couplings[h];
        const std::string name = text(object, ": couplings[", h, "]");
        if (hand.element < 0 || static_cast<std::size_t>(hand.element) >= state.poses.size())
            fail(name, ".element must be in [0, ", state.poses.size(), "), got ", hand.element);
        if (h > 0 && hand.element <= state.couplings[h - 1].element)
            fail(name, ": virtual couplings must ascend by their elements");
        validate(hand.target, name);
        const Vec3 motion[] = {hand.target.pose.position, hand.target.velocity, hand.target.angularVelocity};
        const Quat q = hand.target.pose.orientation;
        if (!usable(motion) || !(std::abs(dot(q, q) - 1.0) < 1e-6))
            fail(name, ".target must lie within ", physics::kFarthest, " m, with a unit quaternion");
    }
}

} // namespace

namespace {

/// Gives links the velocities that follow from those of the base and of the joints.
void moveLinks(const LinkTree& tree, RigidState& state)
{
    std::vector<double> velocities;
    for (const JointState& joint : state.joints) velocities.push_back(joint.now.velocity);
    std::vector<LinkMotion> motion(state.poses.size(), {state.velocities[0], state.angularVelocities[0]});
    moveLinks(tree, jointAxes(tree, state.poses), state.poses, velocities, motion);
    for (std::size_t e = 0; e < motion.size(); ++e) {
        state.velocities[e] = motion[e].linear;
        state.angularVelocities[e] = motion[e].angular;
    }
}

} // namespace

RigidState stateAtStart(const RigidModel& model)
{
    const std::size_t count = model.rest.size();
    std::vector<JointState> joints;
    for (std::size_t j = 0; j < model.articulation.tree.joints.size(); ++j)
        joints.push_back({.command = model.articulation.commands[j],
                          .now = {.position = model.articulation.tree.joints[j].start,
                                  .velocity = model.articulation.tree.joints[j].startVelocity}});
    const auto start = [&](Vec3 v) { return std::vector<Vec3>(count, model.dynamic ? v : Vec3{}); };
    RigidState state{.poses = model.rest,
                     .velocities = start(model.startVelocity),
                     .angularVelocities = start(model.startAngularVelocity),
                     .wrenches = std::vector<Wrench>(count),
                     .targets = std::vector<std::optional<Pose>>(count),
                     .joints = std::move(joints)};
    if (!state.joints.empty()) moveLinks(model.articulation.tree, state);
    return state;
}

void check(const RigidModel& model, const RigidState& state)
{
    const std::string object = text("rigid body '", model.name, "'");
    const std::size_t count = model.rest.size();
    if (count == 0) fail(object, ": elements must have at least one entry");
    checkSize(object, "inertias", model.inertias.size(), count);
    checkSize(object, "poses", state.poses.size(), count);
    checkSize(object, "velocities", state.velocities.size(), count);
    checkSize(object, "angularVelocities", state.angularVelocities.size(), count);
    checkSize(object, "wrenches", state.wrenches.size(), count);
    checkSize(object, "targets", state.targets.size(), count);
    for (const auto& [field, value] : {std::pair{"linearDamping", model.linearDamping},
                                       {"angularDamping", model.angularDamping},
                                       {"friction", model.friction}})
        if (!nonNegative().contains(value)) fail(object, ": ", field, " must be >= 0, got ", value);
    checkJoints(object, model, state);
    checkCollision(object, model);
    if (model.surface) geometry::check(*model.surface, object + ": surface");
    const Vec3 start[] = {model.startVelocity, model.startAngularVelocity};
    if (model.dynamic && !(usable(start) && usable(state.velocities) && usable(state.angularVelocities)))
        fail(object, ": velocities must be < ", physics::kFarthest, " m/s and rad/s");

    for (std::size_t e = 0; e < count; ++e) {
        checkPose(object, model.rest[e]);
        checkPose(object, state.poses[e]);
        if (state.targets[e]) checkPose(object, *state.targets[e]);
        if (model.dynamic) checkInertia(text(object, ": inertias[", e, "]"), model.inertias[e]);
        if (model.dynamic && state.targets[e]) fail(object, ": a dynamic body has no targets");
        if (!isFinite(state.wrenches[e].force) || !isFinite(state.wrenches[e].torque))
            fail(object, ": wrenches must be finite");
    }
    checkCouplings(object, model, state);
}

} // namespace filasofia::engine
