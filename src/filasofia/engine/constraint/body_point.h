#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <cstddef>

namespace filasofia::engine {

/// A point of a body, or of space, where a constraint acts; or what turns about an axis: an edge of a rod about itself,
/// or an element of a rigid body.
struct BodyPoint {
    enum class Of { Space, Soft, Rigid, Joint, RodEdge, Turning };
    Of of = Of::Space;
    /// Index among the soft bodies, or in the rigid plan; for a joint, the index there of its articulation's base.
    std::size_t body = 0;
    int joint = 0; ///< Joint: the joint's velocity is stored along x, times a length (JointInfo::arm)
    int edge = 0;  ///< RodEdge
    /// [m] RodEdge, Turning: a unit vector times a length. The velocity about it is stored along x, times that length,
    /// and so is the angle in `position`
    Vec3 axis = {};
    /// Soft, on the surface of a rod: the edges that turn the point as they turn about themselves, and its velocity per
    /// spin of each [m]; -1: none
    std::array<int, 2> edges{-1, -1};
    std::array<Vec3, 2> perSpin{};
    int count = 0; ///< Soft: number of nodes that the point is a weighted mean of, at most 12
    std::array<int, 12> nodes{};
    std::array<double, 12> weights{};
    Vec3 position; ///< [m] at the start of the step
    Vec3 shift;    ///< [m] Rigid: from `position` to where the constraint acts (turnContact(), armOfChord())
    Vec3 velocity; ///< [m/s] at the start of the step; if nothing can change it, during the whole step

    void add(int node, double weight);
};

} // namespace filasofia::engine
