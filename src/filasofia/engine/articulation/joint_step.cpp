#include "filasofia/engine/articulation/joint_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace filasofia::engine {
namespace {

// The rounds of the centred step: each makes its error smaller by about the angle h w that the body turns in a step.
// Beyond kShrinking it would not end.
constexpr int kMostRounds = 12;
constexpr double kShrinking = 0.5, kSettled = 1e-8; // [-]

/// [m] The length that turns a joint's velocity into one in [m/s]: the radius of gyration of all that it moves, or 1 if
/// the joint slides or moves no mass.
double armOf(const MovingTree& moving, int joint, double inertia)
{
    if (slides(moving.tree, joint)) return 1.0;
    double mass = 0.0;
    for (std::size_t link = 0; link < moving.masses.size(); ++link)
        if (moves(moving.tree, joint, static_cast<int>(link))) mass += moving.masses[link].mass;
    return mass > 0.0 ? std::sqrt(inertia / mass) : 1.0;
}

/// [N m s] or [N s/m] The damping matrix of the free joints: their own damping and that of the body's motion.
JointMatrix dampingOf(const MovingTree& moving, const JointDrive& drive)
{
    std::vector<LinkMass> slowed(moving.masses.begin(), moving.masses.end());
    for (LinkMass& link : slowed) {
        link.mass *= drive.freeBase ? drive.linearDamping : 0.0;
        link.inertia *= drive.freeBase ? drive.angularDamping : 0.0;
    }
    JointMatrix damping = massMatrix(moving.tree, moving.axes, slowed, drive.free);
    for (std::size_t f = 0; f < drive.free.size(); ++f) {
        if (isOfBase(moving.tree, drive.free[f])) continue;
        const LinkJoint& joint = moving.tree.joints[static_cast<std::size_t>(drive.free[f])];
        damping(f, f) += joint.damping - joint.inertia;
    }
    return damping;
}

/// [rad/s] or [m/s] The change of the free joints' velocities, without constraints, if the inertial forces are those of
/// the velocities that differ from the start's by `change`. `given` [N m] or [N]: the other forces.
std::vector<double> changeAt(const MovingTree& moving, const JointDrive& drive, std::span<const double> given,
                             const JointMatrix& inverse, std::span<const double> change, double dt)
{
    std::vector<double> velocities(moving.velocities.begin(), moving.velocities.end());
    addVelocities(moving.tree, drive.free.first(change.size()), change, velocities);
    MovingTree then = moving;
    then.velocities = velocities;
    if (drive.freeBase) {
        const std::span<const double> base = std::span(velocities).last(kBaseJoints);
        then.baseVelocity = {{base[0], base[1], base[2]}, {base[3], base[4], base[5]}};
    }
    std::vector<double> impulses = inverseDynamics(then, drive.gravity, drive.free);
    for (std::size_t f = 0; f < impulses.size(); ++f) impulses[f] = dt * (given[f] - impulses[f]);
    std::vector<double> out(impulses.size());
    multiply(inverse, impulses, out);
    return out;
}

/// The change with the inertial forces in the middle of the step, by fixed-point iteration: see the head of
/// joint_step.h. If a body turns too far in a step for that, those of its start.
std::vector<double> centredChange(const MovingTree& moving, const JointDrive& drive, std::span<const double> given,
                                  const JointMatrix& inverse, double dt)
{
    const std::vector<double> first = changeAt(moving, drive, given, inverse, {}, dt);
    std::vector<double> change = first;
    double last = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kMostRounds; ++round) {
        std::vector<double> half = change;
        for (double& each : half) each *= 0.5;
        std::vector<double> next = changeAt(moving, drive, given, inverse, half, dt);
        double moved = 0.0, size = 0.0; // in squares
        for (std::size_t f = 0; f < next.size(); ++f) {
            moved += (next[f] - change[f]) * (next[f] - change[f]);
            size += next[f] * next[f];
        }
        if (!(moved <= kShrinking * kShrinking * last)) return first;
        change = std::move(next);
        if (moved <= kSettled * kSettled * size) break;
        last = moved;
    }
    return change;
}

} // namespace

JointStep planJoints(const MovingTree& moving, const JointDrive& drive, double dt)
{
    JointStep out;
    out.matrix = massMatrix(moving.tree, moving.axes, moving.masses, drive.free);
    const JointMatrix damping = dampingOf(moving, drive);
    std::vector<double> speeds, given(drive.free.size());
    for (const int joint : drive.free) speeds.push_back(moving.velocities[static_cast<std::size_t>(joint)]);
    multiply(damping, speeds, given);
    for (std::size_t f = 0; f < drive.free.size(); ++f) {
        out.arms.push_back(armOf(moving, drive.free[f], out.matrix(f, f)));
        given[f] = drive.forces[f] - given[f];
    }
    for (std::size_t i = 0; i < damping.entries.size(); ++i) out.matrix.entries[i] += dt * damping.entries[i];
    out.inverse = inverse(out.matrix);
    out.change = centredChange(moving, drive, given, out.inverse, dt);
    return out;
}

double forceOn(const LinkTree& tree, std::span<const JointAxis> axes, int joint, int link, Vec3 point, Vec3 force,
               Vec3 torque)
{
    const LinkMotion column = columnAt(tree, axes, joint, link, point);
    return dot(column.linear, force) + dot(column.angular, torque);
}

double positionAfter(const LinkJoint& joint, double position, double target, double dt)
{
    const double end = std::clamp(target, joint.lower, joint.upper);
    const double way = end - position, maxWay = joint.speed * dt;
    return std::abs(way) <= maxWay ? end : position + std::copysign(maxWay, way);
}

JointMotion moved(const LinkJoint& joint, double position, double velocity, double dt)
{
    JointMotion now{position + dt * velocity, velocity};
    // The solver's tolerance lets a joint pass its limit a little.
    if (!(now.position > joint.lower && now.position < joint.upper)) {
        now.position = std::clamp(now.position, joint.lower, joint.upper);
        now.velocity = now.position == joint.lower ? std::max(0.0, now.velocity) : std::min(0.0, now.velocity);
    }
    return now;
}

std::vector<LinkMotion> linkChanges(const LinkTree& tree, std::span<const JointAxis> axes, std::span<const Pose> poses,
                                    std::span<const int> free, std::span<const double> change)
{
    std::vector<double> all(tree.joints.size() + kBaseJoints);
    addVelocities(tree, free, change, all);
    const std::span<const double> base = std::span(all).subspan(tree.joints.size());
    std::vector<LinkMotion> motion(tree.jointOf.size());
    motion[0] = {{base[0], base[1], base[2]}, {base[3], base[4], base[5]}};
    moveLinks(tree, axes, poses, all, motion);
    return motion;
}

} // namespace filasofia::engine
