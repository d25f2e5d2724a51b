#include "filasofia/engine/articulation/link_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace filasofia::engine {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

Pose motionOf(const LinkJoint& joint, double q)
{
    return joint.prismatic ? Pose{q * joint.axis, {}} : Pose{{}, axisAngle(joint.axis, q)};
}

/// The velocity of a joint's child link from those of the joint and its parent link.
LinkMotion childMotion(const LinkJoint& joint, const JointAxis& axis, std::span<const Pose> poses,
                       const LinkMotion& parent, double velocity)
{
    const Vec3 from = poses[at(joint.parent)].position, to = poses[at(joint.child)].position;
    const Vec3 along = velocity * axis.direction;
    if (joint.prismatic) return {parent.linear + cross(parent.angular, to - from) + along, parent.angular};
    const Vec3 spin = parent.angular + along;
    return {parent.linear + cross(parent.angular, axis.origin - from) + cross(spin, to - axis.origin), spin};
}

/// The acceleration of a joint's child link from the velocity and the acceleration of its parent link.
LinkMotion childAcceleration(const MovingTree& all, int number, const LinkMotion& velocity, const LinkMotion& parent)
{
    const LinkJoint& joint = all.tree.joints[at(number)];
    const JointAxis& axis = all.axes[at(number)];
    const Vec3 from = all.poses[at(joint.parent)].position, to = all.poses[at(joint.child)].position;
    const Vec3 w = velocity.angular, moving = all.velocities[at(number)] * axis.direction;
    const Vec3 gaining = all.accelerations[at(number)] * axis.direction;
    const auto carried = [](const LinkMotion& a, Vec3 spin, Vec3 arm) {
        return cross(a.angular, arm) + cross(spin, cross(spin, arm));
    };
    if (joint.prismatic)
        return {parent.linear + carried(parent, w, to - from) + 2.0 * cross(w, moving) + gaining, parent.angular};
    const LinkMotion turning{{}, parent.angular + gaining + cross(w, moving)};
    const Vec3 atAxis = parent.linear + carried(parent, w, axis.origin - from);
    return {atAxis + carried(turning, w + moving, to - axis.origin), turning.angular};
}

/// Whether a joint lies on the path from the base to a link.
bool carries(const LinkTree& tree, int joint, int link)
{
    for (int j = tree.jointOf[at(link)]; j >= 0; j = tree.jointOf[at(tree.joints[at(j)].parent)])
        if (j == joint) return true;
    return false;
}

/// The velocity of a point on a part that the joint carries, if its own velocity is 1.
LinkMotion ownColumn(const LinkTree& tree, std::span<const JointAxis> axes, int joint, Vec3 point)
{
    const JointAxis& axis = axes[at(joint)];
    if (slides(tree, joint)) return {axis.direction, {}};
    return {cross(axis.direction, point - axis.origin), axis.direction};
}

} // namespace

bool isOfBase(const LinkTree& tree, int joint) { return at(joint) >= tree.joints.size(); }

bool slides(const LinkTree& tree, int joint)
{
    return isOfBase(tree, joint) ? at(joint) < tree.joints.size() + 3 : tree.joints[at(joint)].prismatic;
}

void placeLinks(const LinkTree& tree, std::span<const double> positions, std::span<Pose> poses)
{
    for (int j : tree.order) {
        const LinkJoint& joint = tree.joints[at(j)];
        Pose& child = poses[at(joint.child)];
        child = poses[at(joint.parent)] * joint.parentOffset * motionOf(joint, positions[at(j)]) *
                inverse(joint.childOffset);
        child.orientation = normalized(child.orientation);
    }
}

std::vector<JointAxis> jointAxes(const LinkTree& tree, std::span<const Pose> poses)
{
    std::vector<JointAxis> axes;
    for (const LinkJoint& joint : tree.joints) {
        const Pose frame = poses[at(joint.parent)] * joint.parentOffset; // the joint's motion does not move its axis
        axes.push_back({rotate(frame.orientation, joint.axis), frame.position});
    }
    for (int k = 0; k < kBaseJoints; ++k) axes.push_back({Mat3::identity()[k % 3], poses[0].position});
    return axes;
}

bool moves(const LinkTree& tree, int joint, int link)
{
    if (isOfBase(tree, joint) || carries(tree, joint, link)) return true;
    return std::ranges::any_of(tree.followers[at(joint)], [&](int each) { return carries(tree, each, link); });
}

LinkMotion columnAt(const LinkTree& tree, std::span<const JointAxis> axes, int joint, int link, Vec3 point)
{
    if (isOfBase(tree, joint) || tree.followers[at(joint)].empty()) return ownColumn(tree, axes, joint, point);
    LinkMotion sum;
    if (carries(tree, joint, link)) sum = ownColumn(tree, axes, joint, point);
    for (const int each : tree.followers[at(joint)]) {
        if (!carries(tree, each, link)) continue;
        const LinkMotion column = ownColumn(tree, axes, each, point);
        sum.linear += tree.joints[at(each)].multiplier * column.linear;
        sum.angular += tree.joints[at(each)].multiplier * column.angular;
    }
    return sum;
}

void addVelocities(const LinkTree& tree, std::span<const int> free, std::span<const double> change,
                   std::span<double> velocities)
{
    for (std::size_t f = 0; f < free.size(); ++f) {
        velocities[at(free[f])] += change[f];
        if (isOfBase(tree, free[f])) continue;
        for (const int each : tree.followers[at(free[f])])
            velocities[at(each)] += tree.joints[at(each)].multiplier * change[f];
    }
}

void moveLinks(const LinkTree& tree, std::span<const JointAxis> axes, std::span<const Pose> poses,
               std::span<const double> velocities, std::span<LinkMotion> motion)
{
    for (int j : tree.order) {
        const LinkJoint& joint = tree.joints[at(j)];
        motion[at(joint.child)] = childMotion(joint, axes[at(j)], poses, motion[at(joint.parent)], velocities[at(j)]);
    }
}

void multiply(const JointMatrix& a, std::span<const double> x, std::span<double> out)
{
    for (std::size_t r = 0; r < a.size; ++r) {
        double sum = 0.0;
        for (std::size_t c = 0; c < a.size; ++c) sum += a(r, c) * x[c];
        out[r] = sum;
    }
}

JointMatrix inverse(const JointMatrix& a)
{
    const std::size_t n = a.size;
    JointMatrix lower{n, std::vector<double>(n * n)}, out{n, std::vector<double>(n * n)};
    for (std::size_t r = 0; r < n; ++r)
        for (std::size_t c = 0; c <= r; ++c) {
            double sum = a(r, c);
            for (std::size_t k = 0; k < c; ++k) sum -= lower(r, k) * lower(c, k);
            lower(r, c) = r == c ? std::sqrt(sum) : sum / lower(c, c);
        }
    for (std::size_t column = 0; column < n; ++column) {
        std::vector<double> x(n);
        x[column] = 1.0;
        for (std::size_t r = 0; r < n; ++r) {
            for (std::size_t k = 0; k < r; ++k) x[r] -= lower(r, k) * x[k];
            x[r] /= lower(r, r);
        }
        for (std::size_t r = n; r-- > 0;) {
            for (std::size_t k = r + 1; k < n; ++k) x[r] -= lower(k, r) * x[k];
            x[r] /= lower(r, r);
        }
        for (std::size_t r = 0; r <= column; ++r) out(r, column) = out(column, r) = x[r]; // symmetric to the last bit
    }
    return out;
}

JointMatrix massMatrix(const LinkTree& tree, std::span<const JointAxis> axes, std::span<const LinkMass> masses,
                       std::span<const int> joints)
{
    JointMatrix matrix{joints.size(), std::vector<double>(joints.size() * joints.size())};
    for (std::size_t link = 0; link < masses.size(); ++link) {
        const LinkMass& body = masses[link];
        // A link may have inertia without mass, as damping may act on rotation alone.
        if (body.mass == 0.0 && body.inertia == Mat3{}) continue;
        for (std::size_t r = 0; r < joints.size(); ++r) {
            if (!moves(tree, joints[r], static_cast<int>(link))) continue;
            const LinkMotion row = columnAt(tree, axes, joints[r], static_cast<int>(link), body.centre);
            for (std::size_t c = 0; c <= r; ++c) {
                if (!moves(tree, joints[c], static_cast<int>(link))) continue;
                const LinkMotion column = columnAt(tree, axes, joints[c], static_cast<int>(link), body.centre);
                matrix(r, c) +=
                    body.mass * dot(row.linear, column.linear) + dot(row.angular, body.inertia * column.angular);
            }
        }
    }
    for (std::size_t r = 0; r < joints.size(); ++r) {
        if (!isOfBase(tree, joints[r])) matrix(r, r) += tree.joints[at(joints[r])].inertia;
        for (std::size_t c = 0; c < r; ++c) matrix(c, r) = matrix(r, c);
    }
    return matrix;
}

std::vector<double> inverseDynamics(const MovingTree& moving, Vec3 gravity, std::span<const int> joints)
{
    const LinkTree& tree = moving.tree;
    std::vector<LinkMotion> velocity(moving.masses.size()), acceleration(moving.masses.size());
    velocity[0] = moving.baseVelocity;
    acceleration[0] = moving.baseAcceleration;
    moveLinks(tree, moving.axes, moving.poses, moving.velocities, velocity);
    for (int j : tree.order) {
        const std::size_t parent = at(tree.joints[at(j)].parent), child = at(tree.joints[at(j)].child);
        acceleration[child] = childAcceleration(moving, j, velocity[parent], acceleration[parent]);
    }
    std::vector<double> forces;
    for (int joint : joints)
        forces.push_back(isOfBase(tree, joint) ? 0.0
                                               : tree.joints[at(joint)].inertia * moving.accelerations[at(joint)]);
    for (std::size_t link = 0; link < moving.masses.size(); ++link) {
        const LinkMass& body = moving.masses[link];
        if (body.mass == 0.0) continue;
        const Vec3 arm = body.centre - moving.poses[link].position;
        const Vec3 w = velocity[link].angular, a = acceleration[link].angular;
        const Vec3 ofCentre = acceleration[link].linear + cross(a, arm) + cross(w, cross(w, arm));
        const Vec3 force = body.mass * (ofCentre - gravity);
        const Vec3 torque = body.inertia * a + cross(w, body.inertia * w);
        for (std::size_t r = 0; r < joints.size(); ++r) {
            if (!moves(tree, joints[r], static_cast<int>(link))) continue;
            const LinkMotion column = columnAt(tree, moving.axes, joints[r], static_cast<int>(link), body.centre);
            forces[r] += dot(column.linear, force) + dot(column.angular, torque);
        }
    }
    return forces;
}

} // namespace filasofia::engine
