#include "filasofia/engine/rigid/articulation_step.h"

#include "filasofia/engine/body/usable.h"
#include "filasofia/engine/scene/find_body.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

std::vector<DrivenJoint> drivenJoints(const RigidState& state)
{
    std::vector<DrivenJoint> joints;
    for (const JointState& joint : state.joints)
        joints.push_back({joint.command, {joint.now.position, joint.now.velocity}});
    return joints;
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

/// Finds how far the origins of the links that free joints move get beside their velocities' lines. With the velocities
/// at the start, as what holds a joint is not known yet: the torque of a jaw that a needle stalls would close it at 100
/// rad/s.
void foreseeArcs(const LinkTree& tree, double dt, std::vector<DrivenJoint> joints, const ArticulationPlan& planned,
                 RigidPlan& plan)
{
    const auto link = [&](std::size_t e) -> RigidPlanElement& { return plan[planned.first + e]; };
    const RigidPlanElement& base = link(0);
    std::vector<Pose> ends(tree.jointOf.size(), moved(base.start, {}, base.velocity, base.angularVelocity, dt));
    if (!moveJoints(tree, planned.joints, std::vector<double>(planned.joints.free.size()), dt, joints)) return;
    placeLinks(tree, positionsOf(joints), ends);
    for (std::size_t e = 0; e < ends.size(); ++e)
        if (link(e).dynamic) link(e).beyond = 1.0 / dt * (ends[e].position - link(e).start.position) - link(e).velocity;
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
    const std::vector<DrivenJoint> joints = drivenJoints(now);
    const JointedBody own{tree, joints, now.poses, {now.velocities[0], now.angularVelocities[0]}, rigid.dynamic};
    out.joints = planMotion(own, dt);
    if (dt == 0.0) return out;

    std::vector<Pose> endPoses(now.poses.size(), out.baseEnd);
    placeLinks(tree, out.joints.ends, endPoses);
    if (out.joints.freeBase) {
        plan[first].velocity = now.velocities[0];
        plan[first].angularVelocity = now.angularVelocities[0];
    } else
        planPrescribedMotion(out.baseEnd, dt, plan[first]);
    std::vector<LinkMotion> motion(now.poses.size(), {plan[first].velocity, plan[first].angularVelocity});
    moveLinks(tree, out.joints.axes, now.poses, out.joints.velocities, motion);
    for (std::size_t e = 0; e < now.poses.size(); ++e) {
        RigidPlanElement& link = plan[first + e];
        link.dynamic = std::ranges::any_of(out.joints.free, [&](int j) { return moves(tree, j, static_cast<int>(e)); });
        if (!link.dynamic) {
            if (e > 0) planPrescribedMotion(endPoses[e], dt, link); // kinematic, like all links between it and the base
            continue;
        }
        link.mass = rigid.inertias[e].mass;
        link.velocity = motion[e].linear;
        link.angularVelocity = motion[e].angular;
    }
    if (out.joints.free.empty()) return out;
    planFree(own,
             {.inertias = rigid.inertias,
              .wrenches = now.wrenches,
              .gravity = rigid.gravity ? scene.gravity : Vec3{},
              .linearDamping = rigid.linearDamping,
              .angularDamping = rigid.angularDamping},
             {plan[first].velocity, plan[first].angularVelocity}, dt, out.joints);
    setChange(tree, std::vector<double>(out.joints.step.change), out, plan);
    foreseeArcs(tree, dt, joints, out, plan);
    return out;
}

/// Computes and sets the joints' new state; false, without setting it, if it is not usable.
bool moveJoints(const LinkTree& tree, double dt, const ArticulationPlan& planned, const RigidPlanElement& base,
                RigidState& state)
{
    std::vector<DrivenJoint> joints = drivenJoints(state);
    std::vector<Pose> poses(state.poses.size(), planned.baseEnd);
    if (planned.joints.freeBase) {
        const Vec3 through[] = {base.velocity + base.change.linear, base.angularVelocity + base.change.angular};
        if (!usable(through)) return false;
        poses[0] = moved(base.start, {}, through[0], through[1], dt);
    }
    if (!moveJoints(tree, planned.joints, planned.joints.step.change, dt, joints)) return false;
    placeLinks(tree, positionsOf(joints), poses);
    for (const Pose& pose : poses)
        if (!usable({&pose.position, 1})) return false;
    for (std::size_t j = 0; j < joints.size(); ++j) {
        state.joints[j].now.position = joints[j].now.position;
        state.joints[j].now.velocity = joints[j].now.velocity;
    }
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
    placeLinks(articulation.tree, positionsOf(drivenJoints(own)), own.poses);
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
    std::ranges::copy(change, articulation.joints.step.change.begin());
    std::vector<Pose> poses;
    for (std::size_t e = 0; e < tree.jointOf.size(); ++e) poses.push_back(plan[articulation.first + e].start);
    const std::vector<LinkMotion> motion =
        linkChanges(tree, articulation.joints.axes, poses, articulation.joints.free, change);
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
            placeLinks(tree, positionsOf(drivenJoints(body)), body.poses);
        }
        if (!good) {
            for (JointState& joint : body.joints) joint.now.velocity = 0.0;
            context.report.setUndone(scene.rigid[planned.body].model.id);
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
