#include "filasofia/sofa/articulation.h"

#include "filasofia/engine/articulation/def_tree.h"
#include "filasofia/engine/integration/rigid.h"
#include "filasofia/physics/limits.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::sofaengine {
namespace {

bool isNear(Vec3 v) { return length(v) < physics::kFarthest; } // no NaN is

/// The velocities that lead from one pose to another; none if that is a jump.
engine::LinkMotion motionTo(const Pose& from, const Pose& to, double dt)
{
    const auto [linear, angular] = engine::velocitiesBetween(from, to, dt);
    if (!(length(linear) <= physics::kTeleport) || !(length(angular) * dt <= physics::kTeleportTurn)) return {};
    return {linear, angular};
}

} // namespace

Articulation::Articulation(const physics::RigidBodyDef& def)
    : tree_(engine::treeOf(def.articulation)), starts_(engine::startCommands(def.articulation)), dynamic_(def.dynamic),
      gravity_(def.gravity), linearDamping_(def.linearDamping), angularDamping_(def.angularDamping)
{
    if (empty()) return;
    inertias_ = physics::linkInertias(def);
    wrenches.resize(inertias_.size());
    rewind();
}

bool Articulation::isDriven() const
{
    return !empty() && (dynamic_ || std::ranges::any_of(state_.commands, physics::isByForce));
}

int Articulation::parentOf(int element) const
{
    if (empty()) return -1;
    const int joint = tree_.jointOf[at(element)];
    return joint < 0 ? -1 : tree_.joints[at(joint)].parent;
}

void Articulation::setCommand(int joint, const physics::JointCommand& command) { state_.commands[at(joint)] = command; }

void Articulation::rewind()
{
    state_ = {.commands = starts_};
    for (const engine::LinkJoint& joint : tree_.joints)
        state_.joints.push_back({.position = joint.start, .velocity = joint.startVelocity});
}

void Articulation::rest()
{
    for (frame::Joint& joint : state_.joints) joint.velocity = 0.0;
}

std::vector<engine::DrivenJoint> Articulation::joints() const
{
    std::vector<engine::DrivenJoint> joints;
    for (std::size_t j = 0; j < state_.joints.size(); ++j)
        joints.push_back({state_.commands[j], {state_.joints[j].position, state_.joints[j].velocity}});
    return joints;
}

void Articulation::place(std::vector<Pose>& poses) const
{
    engine::placeLinks(tree_, engine::positionsOf(joints()), poses);
}

void Articulation::begin(double dt, const Pose& base, Vec3 gravity, RigidState& now)
{
    begun_ = true;
    poses_ = now.poses;
    baseEnd_ = base;
    const std::vector<engine::DrivenJoint> all = joints();
    const engine::JointedBody own{tree_, all, poses_, {now.velocities[0], now.angularVelocities[0]}, dynamic_};
    plan_ = engine::planMotion(own, dt);
    pushed_.assign(plan_.free.size(), 0.0);
    const engine::LinkMotion moving = dynamic_ ? own.base : motionTo(poses_[0], base, dt);
    std::vector<engine::LinkMotion> motion(poses_.size(), moving);
    engine::moveLinks(tree_, plan_.axes, poses_, plan_.velocities, motion);
    if (!plan_.free.empty())
        engine::planFree(own,
                         {.inertias = inertias_,
                          .wrenches = wrenches,
                          .gravity = gravity_ ? gravity : Vec3{},
                          .linearDamping = linearDamping_,
                          .angularDamping = angularDamping_},
                         moving, dt, plan_);

    std::vector<Pose> endPoses(poses_.size(), base);
    engine::placeLinks(tree_, plan_.ends, endPoses);
    moves_.assign(poses_.size(), 0);
    for (std::size_t e = 0; e < poses_.size(); ++e) {
        moves_[e] =
            std::ranges::any_of(plan_.free, [&](int j) { return engine::moves(tree_, j, static_cast<int>(e)); });
        if (moves_[e] == 0) motion[e] = motionTo(poses_[e], endPoses[e], dt);
        now.velocities[e] = motion[e].linear;
        now.angularVelocities[e] = motion[e].angular;
    }
    for (const auto& [link, change] : changes(plan_.step.change)) {
        now.velocities[at(link)] += fromSofa(getVCenter(change));
        now.angularVelocities[at(link)] += fromSofa(getVOrientation(change));
    }
    addRows(dt);
}

void Articulation::addRows(double dt)
{
    rows_.clear();
    for (std::size_t f = 0; f < plan_.free.size(); ++f) {
        if (engine::isOfBase(tree_, plan_.free[f])) continue;
        const engine::LinkJoint& joint = tree_.joints[at(plan_.free[f])];
        const double arm = plan_.step.arms[f], now = state_.joints[at(plan_.free[f])].position;
        const double way = dt * (plan_.velocities[at(plan_.free[f])] + plan_.step.change[f]);
        const Row row{.joint = plan_.free[f], .arm = arm, .high = dt * engine::kMostAtStop};
        if (std::isfinite(joint.lower)) {
            rows_.push_back(row);
            rows_.back().gap = arm * (now + way - joint.lower);
        }
        if (std::isfinite(joint.upper)) {
            rows_.push_back(row);
            rows_.back().sign = -1.0;
            rows_.back().gap = arm * (joint.upper - now - way);
        }
        if (joint.friction > 0.0) {
            rows_.push_back(row);
            rows_.back().limit = false;
            rows_.back().gap = arm * way; // friction would keep it where it is
            rows_.back().high = dt * joint.friction / arm;
            rows_.back().low = -rows_.back().high;
        }
    }
}

/// A joint's links get opposite impulses along or about its axis: they move no other joint.
std::vector<Articulation::Part> Articulation::partsOf(const Row& row) const
{
    const engine::LinkJoint& joint = tree_.joints[at(row.joint)];
    const engine::JointAxis& axis = plan_.axes[at(row.joint)];
    std::vector<Part> parts;
    for (const auto& [link, sign] : {std::pair{joint.child, 1.0}, {joint.parent, -1.0}}) {
        const Vec3 along = sign * row.sign * row.arm * axis.direction;
        const Vec3 lever = cross(axis.origin - poses_[at(link)].position, along);
        parts.emplace_back(link, joint.prismatic ? RigidTypes::Deriv(toSofa(along), toSofa(lever))
                                                 : RigidTypes::Deriv({}, toSofa(along)));
    }
    return parts;
}

std::vector<Articulation::Part> Articulation::changes(std::span<const double> change) const
{
    std::vector<Part> parts;
    if (plan_.free.empty()) return parts;
    const auto motion = engine::linkChanges(tree_, plan_.axes, poses_, plan_.free, change);
    for (std::size_t e = 0; e < motion.size(); ++e)
        if (moves_[e] != 0)
            parts.emplace_back(static_cast<int>(e),
                               RigidTypes::Deriv(toSofa(motion[e].linear), toSofa(motion[e].angular)));
    return parts;
}

/// The changes of the free joints' velocities by impulses on links.
std::vector<double> Articulation::changeBy(std::span<const Part> impulses) const
{
    std::vector<double> pushes(plan_.free.size()), change(plan_.free.size());
    for (const auto& [link, impulse] : impulses)
        for (std::size_t f = 0; f < plan_.free.size(); ++f)
            if (engine::moves(tree_, plan_.free[f], link))
                pushes[f] += engine::forceOn(tree_, plan_.axes, plan_.free[f], link, poses_[at(link)].position,
                                             fromSofa(getVCenter(impulse)), fromSofa(getVOrientation(impulse)));
    if (!plan_.free.empty()) engine::multiply(plan_.step.inverse, pushes, change);
    return change;
}

std::vector<Articulation::Part> Articulation::respond(std::span<const Part> impulses) const
{
    return changes(changeBy(impulses));
}

std::vector<Articulation::Part> Articulation::push(std::span<const Part> impulses)
{
    pushed_ = changeBy(impulses);
    return changes(pushed_);
}

bool Articulation::finish(double dt, bool failed, RigidState& now)
{
    if (!std::exchange(begun_, false)) return true; // the step failed before
    std::vector<engine::DrivenJoint> moved = joints();
    std::vector<Pose> poses(poses_.size(), baseEnd_);
    bool good = !failed;
    if (good && dynamic_) {
        good = isNear(now.velocities[0]) && isNear(now.angularVelocities[0]);
        if (good) poses[0] = engine::moved(poses_[0], {}, now.velocities[0], now.angularVelocities[0], dt);
    }
    std::vector<double> change = pushed_;
    for (std::size_t f = 0; f < plan_.step.change.size(); ++f) change[f] += plan_.step.change[f];
    good = good && engine::moveJoints(tree_, plan_, change, dt, moved);
    if (good) {
        engine::placeLinks(tree_, engine::positionsOf(moved), poses);
        good = std::ranges::all_of(poses, [](const Pose& pose) { return isNear(pose.position); });
    }
    if (good) {
        for (std::size_t j = 0; j < moved.size(); ++j) {
            state_.joints[j].position = moved[j].now.position;
            state_.joints[j].velocity = moved[j].now.velocity;
        }
    } else {
        poses.assign(poses.size(), dynamic_ ? poses_[0] : baseEnd_);
        place(poses);
        rest();
    }
    now.poses = poses;
    for (std::size_t e = 0; !good && e < poses.size(); ++e)
        if (moves_[e] != 0 || failed) now.velocities[e] = now.angularVelocities[e] = {};
    return good || failed;
}

void Articulation::load(std::span<const PointForce> forces, std::span<const double> impulses, double dt)
{
    if (plan_.axes.empty()) return; // no step was made
    for (std::size_t j = 0; j < state_.joints.size(); ++j) {
        frame::Joint& joint = state_.joints[j];
        joint.load = joint.stop = 0.0;
        for (const PointForce& each : forces)
            if (engine::moves(tree_, static_cast<int>(j), each.element))
                joint.load +=
                    engine::forceOn(tree_, plan_.axes, static_cast<int>(j), each.element, each.point, each.force, {});
        const auto* given = std::get_if<physics::JointForce>(&state_.commands[j]);
        joint.force = given ? given->value : -joint.load; // what its motion takes
    }
    for (std::size_t r = 0; r < std::min(rows_.size(), impulses.size()); ++r)
        if (rows_[r].limit) state_.joints[at(rows_[r].joint)].stop += rows_[r].sign * rows_[r].arm * impulses[r] / dt;
}

} // namespace filasofia::sofaengine
