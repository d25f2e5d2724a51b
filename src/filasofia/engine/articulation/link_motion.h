#pragma once

#include "filasofia/engine/articulation/link_tree.h"
#include "filasofia/math/mat3.h"

#include <span>
#include <vector>

/// The motion of a tree of links in reduced coordinates, one per joint (Featherstone, Rigid Body Dynamics Algorithms,
/// 2008; his chapters 4 to 6, here with plain vectors in world axes). The trees of instruments are small, so sums go
/// over all pairs of joints.
///
/// If forces move the base, it has six more joints, three along the world axes and three about them, through its
/// origin. They are numbered after the joints of the tree.
namespace filasofia::engine {

/// A joint's current axis in the world.
struct JointAxis {
    Vec3 direction; ///< unit vector
    Vec3 origin;    ///< [m] origin of the joint's frame
};

/// Velocities or accelerations of a link: linear at its origin, and angular.
struct LinkMotion {
    Vec3 linear, angular;
};

/// A link's mass properties in the world.
struct LinkMass {
    double mass = 0.0; ///< [kg]
    Vec3 centre;       ///< [m] centre of mass
    Mat3 inertia;      ///< [kg m^2] about the centre of mass
};

/// Force and torque on a rigid element at its centre of mass, in world axes.
struct Wrench {
    Vec3 force;  ///< [N]
    Vec3 torque; ///< [N m]
    friend constexpr bool operator==(const Wrench&, const Wrench&) = default;
};

/// Computes the poses of all links from that of the base, poses[0], and the joints' positions.
void placeLinks(const LinkTree& tree, std::span<const double> positions, std::span<Pose> poses);

inline constexpr int kBaseJoints = 6;
bool isOfBase(const LinkTree& tree, int joint);
bool slides(const LinkTree& tree, int joint); ///< false if it rotates

/// The axes of the joints from the poses of the links, followed by those of the base.
std::vector<JointAxis> jointAxes(const LinkTree& tree, std::span<const Pose> poses);

/// Returns whether a joint moves a link, that is, whether it, or a joint that mimics it, lies on the path from the base
/// to the link.
bool moves(const LinkTree& tree, int joint, int link);

/// A column of the Jacobian: the velocity of a point [m] on a link that the joint moves, if the joint's velocity is 1
/// rad/s or 1 m/s.
LinkMotion columnAt(const LinkTree& tree, std::span<const JointAxis> axes, int joint, int link, Vec3 point);

/// Adds changes of the free joints' velocities to the velocities of all, also to those of the joints that mimic them.
void addVelocities(const LinkTree& tree, std::span<const int> free, std::span<const double> change,
                   std::span<double> velocities);

/// Computes the velocities of all links from that of the base, motion[0], and those of the joints.
void moveLinks(const LinkTree& tree, std::span<const JointAxis> axes, std::span<const Pose> poses,
               std::span<const double> velocities, std::span<LinkMotion> motion);

/// A small matrix over the listed joints, stored by rows.
struct JointMatrix {
    std::size_t size = 0;
    std::vector<double> entries;
    double& operator()(std::size_t r, std::size_t c) { return entries[r * size + c]; }
    double operator()(std::size_t r, std::size_t c) const { return entries[r * size + c]; }
};
void multiply(const JointMatrix& a, std::span<const double> x, std::span<double> out);
/// Inverse of a symmetric positive definite matrix (Cholesky).
JointMatrix inverse(const JointMatrix& a);

/// The reduced mass matrix of the listed joints [kg m^2], [kg m] or [kg], including the drives' inertia:
///     M_ij = sum over links of J_i^T m J_j.
JointMatrix massMatrix(const LinkTree& tree, std::span<const JointAxis> axes, std::span<const LinkMass> masses,
                       std::span<const int> joints);

/// Where the links of a tree are and how they move.
struct MovingTree {
    const LinkTree& tree;
    std::span<const JointAxis> axes;
    std::span<const Pose> poses;
    std::span<const LinkMass> masses;
    std::span<const double> velocities;    ///< [rad/s] or [m/s] of all joints
    std::span<const double> accelerations; ///< [rad/s^2] or [m/s^2] of all joints
    LinkMotion baseVelocity, baseAcceleration;
};

/// The forces at the listed joints [N m] or [N] that produce the tree's accelerations, against gravity,
/// velocity-dependent terms and the motion of the base (recursive Newton-Euler).
std::vector<double> inverseDynamics(const MovingTree& moving, Vec3 gravity, std::span<const int> joints);

} // namespace filasofia::engine
