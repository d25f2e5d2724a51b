#pragma once

#include "filasofia/engine/articulation/link_tree.h"
#include "filasofia/math/mat3.h"

#include <array>
#include <span>
#include <vector>

/// The motion of a tree of links in reduced coordinates, one per joint (Featherstone, Rigid Body Dynamics Algorithms,
/// 2008; his chapters 4 to 6, here with plain vectors in world axes). Trees of instruments are small: sums go over all
/// pairs of joints.
///
/// A base that forces move is one with six joints more, three along the axes of the world and three about them, through
/// its origin: wherever joints are numbered they follow on those of the tree.
namespace filasofia::engine {

/// A joint as it is now, in the world.
struct JointAxis {
    Vec3 direction; ///< unit
    Vec3 origin;    ///< [m] of the joint's frame
};

/// Velocities, or accelerations, of links: of their origins, and of turning.
struct LinkMotion {
    Vec3 linear, angular;
};

/// What a link weighs, in the world.
struct LinkMass {
    double mass = 0.0; ///< [kg]
    Vec3 centre;       ///< [m] of mass
    Mat3 inertia;      ///< [kg m^2] about it
};

/// The poses of all links from that of the base, poses[0], and the positions of the joints.
void placeLinks(const LinkTree& tree, std::span<const double> positions, std::span<Pose> poses);

inline constexpr int kBaseJoints = 6;
bool isOfBase(const LinkTree& tree, int joint);
bool slides(const LinkTree& tree, int joint); ///< else it turns

/// Where the joints are, from the poses of the links; then those of the base.
std::vector<JointAxis> jointAxes(const LinkTree& tree, std::span<const Pose> poses);

/// Does a joint move a link: does the way from the base to the link lead over it.
bool moves(const LinkTree& tree, int joint, int link);

/// A column of the Jacobian: how a point [m] of what the joint moves goes when the joint does, by 1 rad/s or 1 m/s.
LinkMotion columnAt(const LinkTree& tree, std::span<const JointAxis> axes, int joint, Vec3 point);

/// Velocities of all links from motion[0], the base's, and those of the joints.
void moveLinks(const LinkTree& tree, std::span<const JointAxis> axes, std::span<const Pose> poses,
               std::span<const double> velocities, std::span<LinkMotion> motion);

/// A small matrix by rows, of the joints that are listed.
struct JointMatrix {
    std::size_t size = 0;
    std::vector<double> entries;
    double& operator()(std::size_t r, std::size_t c) { return entries[r * size + c]; }
    double operator()(std::size_t r, std::size_t c) const { return entries[r * size + c]; }
};
void multiply(const JointMatrix& a, std::span<const double> x, std::span<double> out);
/// Of a symmetric positive definite one (Cholesky).
JointMatrix inverse(const JointMatrix& a);

/// The reduced mass matrix of the listed joints [kg m^2], [kg m] or [kg], drives included:
///     M_ij = sum over links of J_i^T m J_j.
JointMatrix massMatrix(const LinkTree& tree, std::span<const JointAxis> axes, std::span<const LinkMass> masses,
                       std::span<const int> joints);

/// The forces at the listed joints [N m] or [N] that keep the accelerations as given: gravity, and what comes from
/// velocities and from the base (recursive Newton-Euler). `accelerations` [rad/s^2] or [m/s^2] of all joints;
/// `base`: velocity and acceleration of the base.
std::vector<double> inverseDynamics(const LinkTree& tree, std::span<const JointAxis> axes, std::span<const Pose> poses,
                                    std::span<const LinkMass> masses, std::span<const double> velocities,
                                    std::span<const double> accelerations, const std::array<LinkMotion, 2>& base,
                                    Vec3 gravity, std::span<const int> joints);

} // namespace filasofia::engine
