#pragma once

#include "filasofia/math/pose.h"

#include <limits>
#include <string>
#include <vector>

namespace filasofia::engine {

/// How a link moves relative to its parent link. With q the position of the joint,
///     child = parent * parentOffset * M(q) * inverse(childOffset).
struct LinkJoint {
    bool prismatic = false;         ///< slides along its axis [m]; otherwise rotates about it [rad]
    Vec3 axis{0.0, 0.0, 1.0};       ///< unit vector, in the joint's frame
    int parent = 0, child = 1;      ///< indices of links
    Pose parentOffset, childOffset; ///< the joint's frame in each link's coordinates
    double lower = -std::numeric_limits<double>::infinity(); ///< [rad] or [m]
    double upper = std::numeric_limits<double>::infinity();
    double start = 0.0;
    double startVelocity = 0.0; ///< [rad/s] or [m/s]
    double speed = 1.0;         ///< [rad/s] or [m/s] maximum on the way to a commanded position
    double damping = 0.0;       ///< [N m s] or [N s/m]
    double friction = 0.0;      ///< [N m] or [N]
    double inertia = 0.0;       ///< [kg m^2] or [kg] inertia of the drive
    int mimics = -1;            ///< the joint whose position q it follows, to multiplier * q + offset; -1: none
    double multiplier = 0.0;
    double offset = 0.0; ///< [rad] or [m]
};

/// A tree of links. Link 0 is the base.
struct LinkTree {
    std::vector<LinkJoint> joints;
    std::vector<int> order;                  ///< joints, parents first
    std::vector<int> jointOf;                ///< per link: the joint that moves it; -1 for the base
    std::vector<std::vector<int>> followers; ///< per joint: those that mimic it, ascending
};

/// Builds the tree of these joints. Joints that link 0 does not reach are left out of `order`.
LinkTree linkTree(std::vector<LinkJoint> joints);

/// Throws an Error beginning with `object` if the joints do not form a tree or have invalid parameters.
void checkTree(const std::string& object, const LinkTree& tree);

} // namespace filasofia::engine
