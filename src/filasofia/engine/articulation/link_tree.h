#pragma once

#include "filasofia/math/pose.h"

#include <limits>
#include <string>
#include <vector>

namespace filasofia::engine {

/// How one link moves against the one that it hangs on: with q the position of the joint,
///     child = parent * parentOffset * M(q) * inverse(childOffset).
struct LinkJoint {
    bool prismatic = false;                                  ///< slides along its axis [m]; else turns about it [rad]
    Vec3 axis{0.0, 0.0, 1.0};                                ///< unit, in the joint's frame
    int parent = 0, child = 1;                               ///< links
    Pose parentOffset, childOffset;                          ///< the joint's frame in their coordinates
    double lower = -std::numeric_limits<double>::infinity(); ///< [rad] or [m]
    double upper = std::numeric_limits<double>::infinity();
    double start = 0.0;
    double speed = 1.0;    ///< [rad/s] or [m/s], at most, on the way to a commanded position
    double damping = 0.0;  ///< [N m s] or [N s/m]
    double friction = 0.0; ///< [N m] or [N]
    double inertia = 0.0;  ///< [kg m^2] or [kg] of the drive
};

/// A tree of links, of which link 0 is the base.
struct LinkTree {
    std::vector<LinkJoint> joints;
    std::vector<int> order;   ///< of joints, parents first
    std::vector<int> jointOf; ///< per link: the joint that moves it; -1: the base
};

/// The tree of joints that make one.
LinkTree linkTree(std::vector<LinkJoint> joints);

/// Throws an Error beginning with `object` unless the joints make a tree and can be stepped with.
void checkTree(const std::string& object, const LinkTree& tree);

} // namespace filasofia::engine
