#include "filasofia/engine/rigid/rigid_step.h"

#include "filasofia/engine/body/usable.h"
#include "filasofia/engine/rigid/virtual_coupling.h"
#include "filasofia/math/world_inertia.h"
#include "filasofia/physics/limits.h"

namespace filasofia::engine {
namespace {

void planDynamic(const RigidModel& model, double dt, Vec3 gravity, const RigidState& state, RigidPlanElement& out)
{
    const std::size_t e = out.element;
    const physics::RigidInertia& body = model.inertias[e];
    const Pose& pose = state.poses[e];
    out.mass = body.mass;
    out.inertia = worldInertia(body.inertia, pose.orientation);
    out.centre = transform(pose, body.centre);
    out.velocity = state.velocities[e];
    out.angularVelocity = state.angularVelocities[e];
    const RigidLoad load{.mass = body.mass,
                         .inertia = body.inertia,
                         .force = state.wrenches[e].force,
                         .torque = state.wrenches[e].torque,
                         .gravity = model.gravity ? gravity : Vec3{},
                         .linearDamping = model.linearDamping,
                         .angularDamping = model.angularDamping};
    out.change = freeChange(load, pose.orientation, out.velocity, out.angularVelocity, dt);
    for (const ElementCoupling& hand : state.couplings)
        if (static_cast<std::size_t>(hand.element) == e) planCoupling(hand, model, dt, pose, out);
}

void planKinematic(double dt, const RigidState& state, RigidPlanElement& out)
{
    const std::size_t e = out.element;
    out.centre = state.poses[e].position;
    if (state.targets[e]) planPrescribedMotion(*state.targets[e], dt, out);
}

/// Computes and sets the new state; false, without setting it, if it is not usable.
bool moveDynamic(const physics::RigidInertia& body, double dt, const RigidPlanElement& planned, RigidState& state)
{
    const std::size_t e = planned.element;
    const Vec3 through[] = {planned.velocity + planned.change.linear, planned.angularVelocity + planned.change.angular};
    if (!usable(through)) return false;
    const Pose pose = moved(state.poses[e], body.centre, through[0], through[1], dt);
    const Vec3 end[] = {pose.position, turnedVelocity(body.inertia, pose.orientation, through[1], dt)};
    if (!usable(end)) return false;
    state.poses[e] = pose;
    state.velocities[e] = through[0];
    state.angularVelocities[e] = end[1];
    return true;
}

} // namespace

void planPrescribedMotion(const Pose& end, double dt, RigidPlanElement& out)
{
    if (dt == 0.0) return;
    const auto [linear, angular] = velocitiesBetween(out.start, end, dt);
    if (!(length(linear) <= physics::kTeleport) || !(length(angular) * dt <= physics::kTeleportTurn)) return;
    out.velocity = linear;
    out.angularVelocity = angular;
}

std::vector<std::size_t> firstElements(const Scene& scene)
{
    std::vector<std::size_t> first;
    std::size_t count = 0;
    for (const RigidBody& body : scene.rigid) {
        first.push_back(count);
        count += body.model.rest.size();
    }
    return first;
}

void planRigid(const Scene& scene, double dt, RigidPlan& plan)
{
    plan.clear();
    int articulations = 0;
    for (std::size_t b = 0; b < scene.rigid.size(); ++b) {
        const bool links = !scene.rigid[b].model.articulation.tree.joints.empty();
        const std::size_t first = plan.size();
        for (std::size_t e = 0; e < scene.rigid[b].model.rest.size(); ++e) {
            RigidPlanElement& out = plan.emplace_back();
            out.body = b;
            out.element = e;
            out.dynamic = scene.rigid[b].model.dynamic;
            out.start = scene.rigid[b].state.poses[e];
            if (links) {
                out.articulation = articulations;
                out.base = first;
                out.centre = out.start.position;
            } else if (out.dynamic)
                planDynamic(scene.rigid[b].model, dt, scene.gravity, scene.rigid[b].state, out);
            else
                planKinematic(dt, scene.rigid[b].state, out);
        }
        articulations += links ? 1 : 0;
    }
}

void moveRigid(const StepContext& context, const RigidPlan& plan, Scene& scene)
{
    for (const RigidPlanElement& planned : plan) {
        if (planned.articulation >= 0) continue;
        RigidState& body = scene.rigid[planned.body].state;
        const std::size_t e = planned.element;
        if (!planned.dynamic) {
            if (body.targets[e]) body.poses[e] = *body.targets[e];
            body.targets[e].reset();
            body.velocities[e] = planned.velocity;
            body.angularVelocities[e] = planned.angularVelocity;
        } else if (context.dt > 0.0 &&
                   !moveDynamic(scene.rigid[planned.body].model.inertias[e], context.dt, planned, body)) {
            body.velocities[e] = body.angularVelocities[e] = {};
            context.report.setUndone(scene.rigid[planned.body].model.id);
        }
    }
}

} // namespace filasofia::engine
