#include "filasofia/sofa/articulation.h"

#include "filasofia/engine/articulation/def_tree.h"
#include "filasofia/engine/integration/rigid.h"
#include "filasofia/physics/limits.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::sofaengine {
namespace {

using physics::JointForce;
using physics::JointPosition;

// [N] at the arm's length: a stop bears no more, so that a tool which pushes a joint against it does not ask for what
// cannot be. As in the native engine.
constexpr double kMostAtStop = 1000.0;

bool isFree(const physics::JointCommand& command) { return std::holds_alternative<JointForce>(command); }
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

bool Articulation::isDriven() const { return !empty() && (dynamic_ || std::ranges::any_of(state_.commands, isFree)); }

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
    for (const engine::LinkJoint& joint : tree_.joints) state_.joints.push_back({.position = joint.start});
}

void Articulation::rest()
{
    for (frame::Joint& joint : state_.joints) joint.velocity = 0.0;
}

std::vector<double> Articulation::positions() const
{
    std::vector<double> positions;
    for (const frame::Joint& joint : state_.joints) positions.push_back(joint.position);
    return positions;
}

void Articulation::place(std::vector<Pose>& poses) const { engine::placeLinks(tree_, positions(), poses); }

std::vector<engine::LinkMass> Articulation::masses(std::span<const Pose> poses) const
{
    std::vector<engine::LinkMass> masses;
    for (std::size_t e = 0; e < poses.size(); ++e)
        masses.push_back({inertias_[e].mass, transform(poses[e], inertias_[e].centre),
                          engine::worldInertia(inertias_[e].inertia, poses[e].orientation)});
    return masses;
}

/// Finds the free joints and all velocities. `ends`: gets where the others will be.
void Articulation::findFree(double dt, const RigidState& now, std::vector<double>& ends)
{
    velocities_.clear();
    free_.clear();
    place_.assign(tree_.joints.size(), -1);
    for (std::size_t j = 0; j < tree_.joints.size(); ++j) {
        const frame::Joint& joint = state_.joints[j];
        if (isFree(state_.commands[j])) {
            place_[j] = static_cast<int>(free_.size());
            free_.push_back(static_cast<int>(j));
            velocities_.push_back(joint.velocity);
        } else {
            ends[j] = engine::positionAfter(tree_.joints[j], joint.position,
                                            std::get<JointPosition>(state_.commands[j]).value, dt);
            velocities_.push_back((ends[j] - joint.position) / dt);
        }
    }
    if (!dynamic_) return;
    for (int k = 0; k < engine::kBaseJoints; ++k) free_.push_back(static_cast<int>(tree_.joints.size()) + k);
    for (const Vec3& v : {now.velocities[0], now.angularVelocities[0]})
        velocities_.insert(velocities_.end(), {v.x, v.y, v.z});
}

std::vector<double> Articulation::drives(const std::vector<engine::LinkMass>& masses) const
{
    std::vector<double> forces;
    for (const int joint : free_) {
        double force = 0.0;
        if (!engine::isOfBase(tree_, joint)) force = std::get<JointForce>(state_.commands[at(joint)]).value;
        for (std::size_t link = 0; link < masses.size(); ++link)
            if (engine::moves(tree_, joint, static_cast<int>(link)))
                force += engine::forceOn(tree_, axes_, joint, masses[link].centre, wrenches[link].force,
                                         wrenches[link].torque);
        forces.push_back(force);
    }
    return forces;
}

void Articulation::planFree(double dt, const RigidState& now, const engine::LinkMotion& base, Vec3 gravity)
{
    const std::vector<engine::LinkMass> links = masses(now.poses);
    std::vector<double> accelerations(tree_.joints.size());
    for (std::size_t j = 0; j < accelerations.size(); ++j)
        if (place_[j] < 0) accelerations[j] = (velocities_[j] - state_.joints[j].velocity) / dt;
    const engine::LinkMotion gaining{1.0 / dt * (base.linear - now.velocities[0]),
                                     1.0 / dt * (base.angular - now.angularVelocities[0])};
    const std::vector<double> forces = drives(links);
    step_ = engine::planJoints({tree_, axes_, now.poses, links, velocities_, accelerations, base, gaining},
                               {.free = free_,
                                .forces = forces,
                                .gravity = gravity_ ? gravity : Vec3{},
                                .freeBase = dynamic_,
                                .linearDamping = linearDamping_,
                                .angularDamping = angularDamping_},
                               dt);
}

void Articulation::begin(double dt, const Pose& base, Vec3 gravity, RigidState& now)
{
    begun_ = true;
    poses_ = now.poses;
    baseEnd_ = base;
    axes_ = engine::jointAxes(tree_, poses_);
    std::vector<double> ends = positions();
    findFree(dt, now, ends);
    step_ = {};
    pushed_.assign(free_.size(), 0.0);
    engine::LinkMotion moving{now.velocities[0], now.angularVelocities[0]};
    if (!dynamic_) moving = motionTo(poses_[0], base, dt);
    std::vector<engine::LinkMotion> motion(poses_.size(), moving);
    engine::moveLinks(tree_, axes_, poses_, velocities_, motion);
    if (!free_.empty()) planFree(dt, now, moving, gravity);

    std::vector<Pose> endPoses(poses_.size(), base);
    engine::placeLinks(tree_, ends, endPoses);
    moves_.assign(poses_.size(), 0);
    for (std::size_t e = 0; e < poses_.size(); ++e) {
        moves_[e] = std::ranges::any_of(free_, [&](int j) { return engine::moves(tree_, j, static_cast<int>(e)); });
        if (moves_[e] == 0) motion[e] = motionTo(poses_[e], endPoses[e], dt);
        now.velocities[e] = motion[e].linear;
        now.angularVelocities[e] = motion[e].angular;
    }
    for (const auto& [link, change] : changes(step_.change)) {
        now.velocities[at(link)] += fromSofa(getVCenter(change));
        now.angularVelocities[at(link)] += fromSofa(getVOrientation(change));
    }
    addRows(dt);
}

void Articulation::addRows(double dt)
{
    rows_.clear();
    for (std::size_t f = 0; f < free_.size(); ++f) {
        if (engine::isOfBase(tree_, free_[f])) continue;
        const engine::LinkJoint& joint = tree_.joints[at(free_[f])];
        const double arm = step_.arms[f], now = state_.joints[at(free_[f])].position;
        const double way = dt * (velocities_[at(free_[f])] + step_.change[f]);
        const Row row{.joint = free_[f], .arm = arm, .high = dt * kMostAtStop};
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
    const engine::JointAxis& axis = axes_[at(row.joint)];
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
    if (free_.empty()) return parts;
    const auto motion = engine::linkChanges(tree_, axes_, poses_, free_, change);
    for (std::size_t e = 0; e < motion.size(); ++e)
        if (moves_[e] != 0)
            parts.emplace_back(static_cast<int>(e),
                               RigidTypes::Deriv(toSofa(motion[e].linear), toSofa(motion[e].angular)));
    return parts;
}

/// The changes of the free joints' velocities by impulses on links.
std::vector<double> Articulation::changeBy(std::span<const Part> impulses) const
{
    std::vector<double> pushes(free_.size()), change(free_.size());
    for (const auto& [link, impulse] : impulses)
        for (std::size_t f = 0; f < free_.size(); ++f)
            if (engine::moves(tree_, free_[f], link))
                pushes[f] += engine::forceOn(tree_, axes_, free_[f], poses_[at(link)].position,
                                             fromSofa(getVCenter(impulse)), fromSofa(getVOrientation(impulse)));
    if (!free_.empty()) engine::multiply(step_.inverse, pushes, change);
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
    std::vector<frame::Joint> joints = state_.joints;
    std::vector<Pose> poses(poses_.size(), baseEnd_);
    bool good = !failed;
    if (good && dynamic_) {
        good = isNear(now.velocities[0]) && isNear(now.angularVelocities[0]);
        if (good) poses[0] = engine::moved(poses_[0], {}, now.velocities[0], now.angularVelocities[0], dt);
    }
    for (std::size_t j = 0; good && j < joints.size(); ++j) {
        const engine::LinkJoint& joint = tree_.joints[j];
        joints[j].velocity = velocities_[j];
        if (place_[j] < 0) {
            joints[j].position =
                engine::positionAfter(joint, joints[j].position, std::get<JointPosition>(state_.commands[j]).value, dt);
            continue;
        }
        const auto f = at(place_[j]);
        const double velocity = velocities_[j] + step_.change[f] + pushed_[f];
        good = std::abs(velocity) < physics::kFarthest;
        if (!good) break;
        const engine::JointMotion end = engine::moved(joint, joints[j].position, velocity, dt);
        joints[j].position = end.position;
        joints[j].velocity = end.velocity;
    }
    if (good) std::swap(state_.joints, joints);
    place(poses);
    if (good && !std::ranges::all_of(poses, [](const Pose& pose) { return isNear(pose.position); })) {
        good = false;
        std::swap(state_.joints, joints);
    }
    if (!good) {
        poses[0] = dynamic_ ? poses_[0] : baseEnd_;
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
    if (axes_.empty()) return; // no step was made
    for (std::size_t j = 0; j < state_.joints.size(); ++j) {
        frame::Joint& joint = state_.joints[j];
        joint.load = joint.stop = 0.0;
        for (const PointForce& each : forces)
            if (engine::moves(tree_, static_cast<int>(j), each.element))
                joint.load += engine::forceOn(tree_, axes_, static_cast<int>(j), each.point, each.force, {});
        const auto* given = std::get_if<JointForce>(&state_.commands[j]);
        joint.force = given ? given->value : -joint.load; // what its motion takes
    }
    for (std::size_t r = 0; r < std::min(rows_.size(), impulses.size()); ++r)
        if (rows_[r].limit) state_.joints[at(rows_[r].joint)].stop += rows_[r].sign * rows_[r].arm * impulses[r] / dt;
}

} // namespace filasofia::sofaengine
