#include "filasofia/engine/contact/joint_constraints.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace filasofia::engine {
namespace {

// If a limit pushed in the last step, only a part of its gap is closed per step, as for contacts: it then comes to rest
// (find_contacts.cpp).
constexpr double kJointRecovery = 0.05;
constexpr double kJointTolerance = 1e-6; ///< [m] at the arm's length: how far a joint may pass a limit in a step

/// [N m] or [N] The start of the constraint's next solve.
double& carriedBy(JointState& joint, const Constraint& constraint)
{
    if (constraint.kind == ConstraintKind::JointFriction) return joint.frictionForce;
    return constraint.joint.upper ? joint.upperLimitForce : joint.lowerLimitForce;
}

/// A constraint of joint `info` against space; `impulse` [N s] starts its solve.
Constraint jointConstraint(ConstraintKind kind, const JointInfo& info, const ArticulationPlan& plan, double impulse)
{
    Constraint constraint;
    constraint.kind = kind;
    BodyPoint& point = constraint.sides[0];
    point.of = BodyPoint::Of::Joint;
    point.body = plan.first;
    point.joint = info.joint;
    point.velocity.x = info.arm * plan.joints.velocities[static_cast<std::size_t>(info.joint)];
    const double inwards = info.upper ? -1.0 : 1.0;
    constraint.frame = {Vec3{inwards, 0, 0}, Vec3{0, inwards, 0}, Vec3{0, 0, 1}};
    constraint.impulse.x = impulse;
    constraint.joint = info;
    return constraint;
}

/// `gap` [rad] or [m] to the limit; `carried` [N m] or [N] starts its solve.
Constraint limitOf(const JointInfo& info, const ArticulationPlan& plan, double gap, double carried, double dt)
{
    Constraint limit = jointConstraint(ConstraintKind::JointLimit, info, plan, dt * carried / info.arm);
    limit.bias.x = (carried > 0.0 ? kJointRecovery : 1.0) * info.arm * gap / dt;
    limit.tolerance = kJointTolerance / dt;
    limit.maxImpulse = dt * kMostAtStop; // the multipliers would grow without bound
    return limit;
}

Constraint frictionOf(const JointInfo& info, const ArticulationPlan& plan, double torque, double carried, double dt)
{
    Constraint friction = jointConstraint(ConstraintKind::JointFriction, info, plan, dt * carried / info.arm);
    friction.maxImpulse = dt * torque / info.arm;
    friction.tolerance = std::numeric_limits<double>::infinity(); // it may slide
    return friction;
}

// [-] A spring whose impulse per velocity is more than this times the inertia that it moves is as good as rigid, and
// the solver's filter, a difference of large numbers, has digits left.
constexpr double kStiffest = 1e5;

/// The force at the end of the step, k (value - q - h q') - d q', is a soft constraint of the joint's velocity q'.
/// Nothing if it has neither stiffness nor damping. `inertia` [kg m^2] or [kg]: what it moves.
std::optional<Constraint> springOf(const JointInfo& info, const ArticulationPlan& plan,
                                   const physics::JointSpring& given, double position, double inertia, double dt)
{
    const double softness = dt * (dt * given.stiffness + given.damping); // impulse per velocity of the joint
    if (!(softness > 0.0) || !(given.strength > 0.0)) return {};
    Constraint spring = jointConstraint(ConstraintKind::JointSpring, info, plan, 0.0);
    spring.softness = std::min(softness, kStiffest * inertia) / (info.arm * info.arm);
    spring.bias.x = -info.arm * (dt * given.stiffness * (given.value - position) / softness);
    spring.maxImpulse = dt * given.strength / info.arm;
    spring.tolerance = std::numeric_limits<double>::infinity();
    return spring;
}

/// Adds the load of a force at a point of a link, or of a moment about it, to the joints that move the link.
void addLoad(const Coupling& coupling, const BodyPoint& point, Vec3 force, Scene& scene)
{
    const bool turning = point.of == BodyPoint::Of::Turning;
    if ((point.of != BodyPoint::Of::Rigid && !turning) || coupling.rigid[point.body].articulation < 0) return;
    const RigidPlanElement& link = coupling.rigid[point.body];
    const ArticulationPlan& plan = coupling.articulations[static_cast<std::size_t>(link.articulation)];
    const LinkTree& tree = scene.rigid[plan.body].model.articulation.tree;
    const int element = static_cast<int>(link.element);
    for (int j = 0; static_cast<std::size_t>(j) < tree.joints.size(); ++j) {
        if (!moves(tree, j, element)) continue;
        const LinkMotion column = columnAt(tree, plan.joints.axes, j, element, point.position);
        scene.rigid[plan.body].state.joints[static_cast<std::size_t>(j)].now.load +=
            turning ? dot(column.angular, force.x * point.axis) : dot(column.linear, force);
    }
}

} // namespace

void addJointConstraints(double dt, const Scene& scene, Coupling& coupling)
{
    if (dt == 0.0) return;
    for (std::size_t a = 0; a < coupling.articulations.size(); ++a) {
        const ArticulationPlan& plan = coupling.articulations[a];
        const RigidBody& body = scene.rigid[plan.body];
        const LinkTree& tree = body.model.articulation.tree;
        for (std::size_t f = 0; f < plan.joints.free.size(); ++f) {
            if (isOfBase(tree, plan.joints.free[f])) continue;
            const auto j = static_cast<std::size_t>(plan.joints.free[f]);
            const LinkJoint& joint = tree.joints[j];
            const JointState& now = body.state.joints[j];
            JointInfo info{.articulation = a, .joint = plan.joints.free[f], .arm = plan.joints.step.arms[f]};
            if (std::isfinite(joint.lower))
                coupling.constraints.push_back(
                    limitOf(info, plan, now.now.position - joint.lower, now.lowerLimitForce, dt));
            info.upper = true;
            if (std::isfinite(joint.upper))
                coupling.constraints.push_back(
                    limitOf(info, plan, joint.upper - now.now.position, now.upperLimitForce, dt));
            info.upper = false;
            if (joint.friction > 0.0)
                coupling.constraints.push_back(frictionOf(info, plan, joint.friction, now.frictionForce, dt));
            if (const auto* given = std::get_if<physics::JointSpring>(&now.command))
                if (auto spring =
                        springOf(info, plan, *given, now.now.position, 1.0 / plan.joints.step.inverse(f, f), dt))
                    coupling.constraints.push_back(*spring);
        }
    }
}

void keepJoints(double dt, const Coupling& coupling, Scene& scene)
{
    if (dt == 0.0) return;
    for (const ArticulationPlan& plan : coupling.articulations)
        for (JointState& joint : scene.rigid[plan.body].state.joints) {
            joint.now.load = joint.now.stop = joint.now.force = 0.0;
            joint.lowerLimitForce = joint.upperLimitForce = joint.frictionForce = 0.0;
        }
    for (const std::span<const Constraint> kind : {coupling.contacts(), coupling.welds(), coupling.channels()})
        for (const Constraint& each : kind) {
            const Vec3 force = 1.0 / dt * inWorld(each.frame, each.impulse);
            addLoad(coupling, each.sides[0], force, scene);
            addLoad(coupling, each.sides[1], -force, scene);
        }
    for (const Constraint& each : coupling.joints()) {
        const JointInfo& about = each.joint;
        const std::size_t body = coupling.articulations[about.articulation].body;
        JointState& joint = scene.rigid[body].state.joints[static_cast<std::size_t>(about.joint)];
        const double force = about.arm * each.impulse.x / dt;
        if (each.kind == ConstraintKind::JointSpring) {
            joint.now.force = force;
            continue;
        }
        carriedBy(joint, each) = about.arm * each.multiplier.x / dt;
        if (each.kind == ConstraintKind::JointLimit) joint.now.stop += about.upper ? -force : force;
    }
    for (const ArticulationPlan& plan : coupling.articulations)
        for (JointState& joint : scene.rigid[plan.body].state.joints) {
            if (const auto* given = std::get_if<physics::JointForce>(&joint.command))
                joint.now.force = given->value;
            else if (std::holds_alternative<physics::JointPosition>(joint.command))
                joint.now.force = -joint.now.load;
        }
}

} // namespace filasofia::engine
