#include "filasofia/engine/rigid/articulation_step.h"

#include "filasofia/engine/body/usable.h"
#include "filasofia/engine/scene/find_body.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

using physics::JointForce;
using physics::JointPosition;

bool isFree(const JointState& joint) { return std::holds_alternative<JointForce>(joint.command); }

std::vector<double> positionsOf(const std::vector<JointState>& joints)
{
    std::vector<double> positions;
    for (const JointState& joint : joints) positions.push_back(joint.now.position);
    return positions;
}

/// The position of a joint with a position command at the end of the step.
double endOf(const LinkJoint& joint, const JointState& state, double dt)
{
    return positionAfter(joint, state.now.position, std::get<JointPosition>(state.command).value, dt);
}

/// The pose of an element that carries a base at the end of the step.
Pose endOf(const Scene& scene, const ArticulationPlans& plans, std::size_t body, int element)
{
    for (const ArticulationPlan& other : plans)
        if (other.body == body) return other.baseEnd; // ids ascend: the carrier is planned already
    const auto e = static_cast<std::size_t>(element);
    const RigidState& carrier = scene.rigid[body].state;
    return carrier.targets[e] && !scene.rigid[body].model.dynamic ? *carrier.targets[e] : carrier.poses[e];
}

Pose baseEnd(const Scene& scene, const ArticulationPlans& plans, std::size_t body)
{
    const ArticulationModel& articulation = scene.rigid[body].model.articulation;
    if (const auto carrier = findIn(scene.rigid, articulation.to))
        return endOf(scene, plans, *carrier, articulation.toElement) * articulation.offset;
    const RigidState& own = scene.rigid[body].state;
    return own.targets[0].value_or(own.poses[0]);
}

std::vector<LinkMass> massesOf(const RigidModel& model, const RigidState& state)
{
    std::vector<LinkMass> masses;
    for (std::size_t e = 0; e < model.rest.size(); ++e) {
        const physics::RigidInertia& own = model.inertias[e];
        const Pose& pose = state.poses[e];
        masses.push_back({own.mass, transform(pose, own.centre), worldInertia(own.inertia, pose.orientation)});
    }
    return masses;
}

/// [N m] or [N] The force on a free joint: its command and the wrenches on the links that it moves.
double givenForce(const LinkTree& tree, const std::vector<LinkMass>& masses, const RigidState& state,
                  const ArticulationPlan& plan, int joint)
{
    double force = 0.0;
    if (!isOfBase(tree, joint))
        force = std::get<JointForce>(state.joints[static_cast<std::size_t>(joint)].command).value;
    for (std::size_t link = 0; link < masses.size(); ++link) {
        const Wrench& wrench = state.wrenches[link];
        if (wrench == Wrench{} || !moves(tree, joint, static_cast<int>(link))) continue;
        force += forceOn(tree, plan.axes, joint, masses[link].centre, wrench.force, wrench.torque);
    }
    return force;
}

void planFree(const RigidModel& model, const RigidState& state, const RigidPlanElement& base, double dt, Vec3 gravity,
              ArticulationPlan& out)
{
    const LinkTree& tree = model.articulation.tree;
    const std::vector<LinkMass> masses = massesOf(model, state);
    std::vector<double> accelerations(tree.joints.size());
    for (std::size_t j = 0; j < accelerations.size(); ++j)
        if (out.place[j] < 0) accelerations[j] = (out.velocities[j] - state.joints[j].now.velocity) / dt;
    const LinkMotion moving{base.velocity, base.angularVelocity};
    const LinkMotion gaining{1.0 / dt * (base.velocity - state.velocities[0]), // zero if the base is free
                             1.0 / dt * (base.angularVelocity - state.angularVelocities[0])};
    std::vector<double> forces;
    for (const int joint : out.free) forces.push_back(givenForce(tree, masses, state, out, joint));
    out.step = planJoints({tree, out.axes, state.poses, masses, out.velocities, accelerations, moving, gaining},
                          {.free = out.free,
                           .forces = forces,
                           .gravity = model.gravity ? gravity : Vec3{},
                           .freeBase = out.freeBase,
                           .linearDamping = model.linearDamping,
                           .angularDamping = model.angularDamping},
                          dt);
}

/// Finds the free joints and all velocities. `ends` [rad] or [m]: gets the end positions of the kinematic joints.
void findFree(const RigidModel& model, const RigidState& now, double dt, std::vector<double>& ends,
              ArticulationPlan& out)
{
    const LinkTree& tree = model.articulation.tree;
    out.place.assign(tree.joints.size(), -1);
    for (std::size_t j = 0; j < tree.joints.size(); ++j) {
        if (isFree(now.joints[j])) {
            out.place[j] = static_cast<int>(out.free.size());
            out.free.push_back(static_cast<int>(j));
            out.velocities.push_back(now.joints[j].now.velocity);
        } else {
            ends[j] = endOf(tree.joints[j], now.joints[j], dt);
            out.velocities.push_back(dt > 0.0 ? (ends[j] - now.joints[j].now.position) / dt : 0.0);
        }
    }
    out.freeBase = model.dynamic;
    if (!out.freeBase) return;
    for (int k = 0; k < kBaseJoints; ++k) out.free.push_back(static_cast<int>(tree.joints.size()) + k);
    for (const Vec3& v : {now.velocities[0], now.angularVelocities[0]})
        out.velocities.insert(out.velocities.end(), {v.x, v.y, v.z});
}

/// Plans the step of one body. `plans`: those of the bodies before it.
ArticulationPlan planBody(const Scene& scene, double dt, std::size_t body, std::size_t first,
                          const ArticulationPlans& plans, RigidPlan& plan)
{
    const RigidModel& rigid = scene.rigid[body].model;
    const RigidState& now = scene.rigid[body].state;
    const LinkTree& tree = rigid.articulation.tree;
    ArticulationPlan out;
    out.body = body;
    out.first = first;
    out.baseEnd = baseEnd(scene, plans, body);
    out.axes = jointAxes(tree, now.poses);
    std::vector<double> ends = positionsOf(now.joints);
    findFree(rigid, now, dt, ends, out);
    if (dt == 0.0) return out;

    std::vector<Pose> endPoses(now.poses.size(), out.baseEnd);
    placeLinks(tree, ends, endPoses);
    if (out.freeBase) {
        plan[first].velocity = now.velocities[0];
        plan[first].angularVelocity = now.angularVelocities[0];
    } else
        planPrescribedMotion(out.baseEnd, dt, plan[first]);
    std::vector<LinkMotion> motion(now.poses.size(), {plan[first].velocity, plan[first].angularVelocity});
    moveLinks(tree, out.axes, now.poses, out.velocities, motion);
    for (std::size_t e = 0; e < now.poses.size(); ++e) {
        RigidPlanElement& link = plan[first + e];
        link.dynamic = std::ranges::any_of(out.free, [&](int j) { return moves(tree, j, static_cast<int>(e)); });
        if (!link.dynamic) {
            if (e > 0) planPrescribedMotion(endPoses[e], dt, link); // kinematic, like all links between it and the base
            continue;
        }
        link.mass = rigid.inertias[e].mass;
        link.velocity = motion[e].linear;
        link.angularVelocity = motion[e].angular;
    }
    if (out.free.empty()) return out;
    planFree(rigid, now, plan[first], dt, scene.gravity, out);
    setChange(tree, std::vector<double>(out.step.change), out, plan);
    return out;
}

/// Computes and sets the joints' new state; false, without setting it, if it is not usable.
bool moveJoints(const LinkTree& tree, double dt, const ArticulationPlan& planned, const RigidPlanElement& base,
                RigidState& state)
{
    std::vector<JointState> joints = state.joints;
    std::vector<Pose> poses(state.poses.size(), planned.baseEnd);
    if (planned.freeBase) {
        const Vec3 through[] = {base.velocity + base.change.linear, base.angularVelocity + base.change.angular};
        if (!usable(through)) return false;
        poses[0] = moved(base.start, {}, through[0], through[1], dt);
    }
    for (std::size_t j = 0; j < joints.size(); ++j) {
        const LinkJoint& joint = tree.joints[j];
        frame::Joint& now = joints[j].now;
        now.velocity = planned.velocities[j];
        if (planned.place[j] < 0) {
            now.position = endOf(joint, joints[j], dt);
            continue;
        }
        now.velocity += planned.step.change[static_cast<std::size_t>(planned.place[j])];
        if (!(std::abs(now.velocity) < physics::kFarthest)) return false;
        const JointMotion end = moved(joint, now.position, now.velocity, dt);
        now.position = end.position;
        now.velocity = end.velocity;
    }
    placeLinks(tree, positionsOf(joints), poses);
    for (const Pose& pose : poses)
        if (!usable({&pose.position, 1})) return false;
    state.joints = std::move(joints);
    state.poses = std::move(poses);
    return true;
}

} // namespace

void placeLinks(std::size_t body, Scene& scene)
{
    const ArticulationModel& articulation = scene.rigid[body].model.articulation;
    if (articulation.tree.joints.empty()) return;
    RigidState& own = scene.rigid[body].state;
    if (const auto carrier = findIn(scene.rigid, articulation.to)) {
        const auto element = static_cast<std::size_t>(articulation.toElement);
        own.poses[0] = scene.rigid[*carrier].state.poses[element] * articulation.offset;
    }
    placeLinks(articulation.tree, positionsOf(own.joints), own.poses);
}

void planArticulations(const Scene& scene, double dt, RigidPlan& plan, ArticulationPlans& plans)
{
    plans.clear();
    std::size_t first = 0;
    for (std::size_t b = 0; b < scene.rigid.size(); ++b) {
        if (!scene.rigid[b].model.articulation.tree.joints.empty())
            plans.push_back(planBody(scene, dt, b, first, plans, plan));
        first += scene.rigid[b].model.rest.size();
    }
}

void setChange(const LinkTree& tree, std::span<const double> change, ArticulationPlan& articulation, RigidPlan& plan)
{
    std::ranges::copy(change, articulation.step.change.begin());
    std::vector<Pose> poses;
    for (std::size_t e = 0; e < tree.jointOf.size(); ++e) poses.push_back(plan[articulation.first + e].start);
    const std::vector<LinkMotion> motion = linkChanges(tree, articulation.axes, poses, articulation.free, change);
    for (std::size_t e = 0; e < motion.size(); ++e)
        if (RigidPlanElement& link = plan[articulation.first + e]; link.dynamic)
            link.change = {motion[e].linear, motion[e].angular};
}

void moveArticulations(const StepContext& context, const ArticulationPlans& plans, const RigidPlan& plan, Scene& scene)
{
    const double dt = context.dt;
    for (const ArticulationPlan& planned : plans) {
        RigidState& body = scene.rigid[planned.body].state;
        const LinkTree& tree = scene.rigid[planned.body].model.articulation.tree;
        body.targets[0].reset();
        bool good = true;
        if (dt > 0.0) good = moveJoints(tree, dt, planned, plan[planned.first], body);
        if (dt == 0.0 || !good) { // the base still gets its prescribed pose
            body.poses[0] = planned.baseEnd;
            placeLinks(tree, positionsOf(body.joints), body.poses);
        }
        if (!good) {
            for (JointState& joint : body.joints) joint.now.velocity = 0.0;
            context.report.set(physics::StepFlag::Undone);
        }
        for (std::size_t e = 0; e < body.poses.size() && dt > 0.0; ++e) {
            const RigidPlanElement& link = plan[planned.first + e];
            const bool asPlanned = good || !link.dynamic;
            body.velocities[e] = asPlanned ? link.velocity + link.change.linear : Vec3{};
            body.angularVelocities[e] = asPlanned ? link.angularVelocity + link.change.angular : Vec3{};
        }
    }
}

} // namespace filasofia::engine
