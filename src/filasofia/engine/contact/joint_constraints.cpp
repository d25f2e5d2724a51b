#include "filasofia/engine/contact/joint_constraints.h"

#include "filasofia/engine/contact/coupling.h"

#include <cmath>

namespace filasofia::engine {
namespace {

using What = JointLink::What;

// A stop that pushed last time is asked for a part of its gap, as contacts are: it then comes to rest (contacts.cpp).
constexpr double kRecovery = 0.05;
constexpr double kSlack = 1e-6; ///< [m] at the arm's length, that a joint may pass a stop before its impulse is raised

// [N] at the arm's length that a stop bears. Where what is told pushes a joint against its stop, both ask for what
// cannot be, and impulses would be raised without end; so the stop gives way in the solve, and the clamp holds the
// joint.
constexpr double kStopBears = 1000.0;

/// [N m] or [N] where the link's solve starts.
double& carriedBy(JointState& joint, What what)
{
    return what == What::LowerStop ? joint.lowerStop : what == What::UpperStop ? joint.upperStop : joint.dry;
}

/// `gap` [rad] or [m] to a stop.
Link linkOf(const JointLink& what, const ArticulationPlan& plan, const LinkJoint& joint, double gap, double carried,
            double dt)
{
    Link link;
    BodyPoint& point = link.sides[0];
    point.of = BodyPoint::Of::Joint;
    point.body = plan.first;
    point.joint = what.joint;
    point.velocity.x = what.arm * plan.velocities[static_cast<std::size_t>(what.joint)];
    const double inwards = what.what == What::UpperStop ? -1.0 : 1.0;
    link.frame = {Vec3{inwards, 0, 0}, Vec3{0, inwards, 0}, Vec3{0, 0, 1}};
    link.impulse.x = dt * carried / what.arm;
    if (what.what == What::Dry) {
        link.most = dt * joint.friction / what.arm;
        link.slack = std::numeric_limits<double>::infinity(); // it may slide
    } else {
        link.friction = 0.0;
        link.bias.x = (carried > 0.0 ? kRecovery : 1.0) * what.arm * gap / dt;
        link.slack = kSlack / dt;
        link.most = dt * kStopBears;
    }
    return link;
}

/// Adds what an impulse at a point of a link does about the joints that move it.
void addLoad(const Model& model, const Coupling& coupling, const BodyPoint& point, Vec3 force, State& state)
{
    if (point.of != BodyPoint::Of::Rigid || coupling.rigid[point.body].articulation < 0) return;
    const RigidPlanElement& link = coupling.rigid[point.body];
    const ArticulationPlan& plan = coupling.articulations[static_cast<std::size_t>(link.articulation)];
    const LinkTree& tree = model.rigidBodies[plan.body].articulation.tree;
    for (int j = tree.jointOf[link.element]; j >= 0;
         j = tree.jointOf[static_cast<std::size_t>(tree.joints[static_cast<std::size_t>(j)].parent)])
        state.rigidBodies[plan.body].joints[static_cast<std::size_t>(j)].now.load +=
            dot(columnAt(tree, plan.axes, j, point.position).linear, force);
}

} // namespace

void linkJoints(const Model& model, double dt, const State& state, Coupling& coupling)
{
    coupling.jointLinks.clear();
    if (dt == 0.0) return;
    for (std::size_t a = 0; a < coupling.articulations.size(); ++a) {
        const ArticulationPlan& plan = coupling.articulations[a];
        for (std::size_t f = 0; f < plan.free.size(); ++f) {
            if (isOfBase(model.rigidBodies[plan.body].articulation.tree, plan.free[f])) continue;
            const auto j = static_cast<std::size_t>(plan.free[f]);
            const LinkJoint& joint = model.rigidBodies[plan.body].articulation.tree.joints[j];
            const JointState& now = state.rigidBodies[plan.body].joints[j];
            const auto add = [&](What what, double gap, double carried) {
                const JointLink made{what, a, plan.free[f], plan.arms[f]};
                coupling.links.push_back(linkOf(made, plan, joint, gap, carried, dt));
                coupling.jointLinks.push_back(made);
            };
            if (std::isfinite(joint.lower)) add(What::LowerStop, now.now.position - joint.lower, now.lowerStop);
            if (std::isfinite(joint.upper)) add(What::UpperStop, joint.upper - now.now.position, now.upperStop);
            if (joint.friction > 0.0) add(What::Dry, 0.0, now.dry);
        }
    }
}

void keepJoints(const Model& model, double dt, const Coupling& coupling, State& state)
{
    if (dt == 0.0) return;
    for (const ArticulationPlan& plan : coupling.articulations)
        for (JointState& joint : state.rigidBodies[plan.body].joints) {
            joint.now.load = joint.now.stop = 0.0;
            joint.lowerStop = joint.upperStop = joint.dry = 0.0;
        }
    const std::size_t others = coupling.links.size() - coupling.jointLinks.size();
    for (std::size_t l = 0; l < others; ++l) {
        const Link& link = coupling.links[l];
        const Vec3 force =
            1.0 / dt *
            (link.impulse.x * link.frame[0] + link.impulse.y * link.frame[1] + link.impulse.z * link.frame[2]);
        addLoad(model, coupling, link.sides[0], force, state);
        addLoad(model, coupling, link.sides[1], -force, state);
    }
    for (std::size_t l = 0; l < coupling.jointLinks.size(); ++l) {
        const JointLink& about = coupling.jointLinks[l];
        const Link& link = coupling.links[others + l];
        const std::size_t body = coupling.articulations[about.articulation].body;
        JointState& joint = state.rigidBodies[body].joints[static_cast<std::size_t>(about.joint)];
        carriedBy(joint, about.what) = about.arm * link.next.x / dt;
        const double force = about.arm * link.impulse.x / dt;
        if (about.what != What::Dry) joint.now.stop += about.what == What::LowerStop ? force : -force;
    }
    for (const ArticulationPlan& plan : coupling.articulations)
        for (JointState& joint : state.rigidBodies[plan.body].joints) {
            const auto* given = std::get_if<physics::JointForce>(&joint.command);
            joint.now.force = given ? given->value : -joint.now.load;
        }
}

} // namespace filasofia::engine
