#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

namespace filasofia::engine {

/// A point of a body, or of space, where something takes hold of it.
struct BodyPoint {
    enum class Of { Space, Soft, Rigid, Joint };
    Of of = Of::Space;
    std::size_t body = 0; ///< place among the soft bodies, or in the rigid plan; of a joint: of its body's base
    int joint = 0;        ///< of an articulated body; its velocity is along x, times a length (JointLink::arm)
    int count = 0;        ///< soft: the nodes that it is a mean of, at most twelve
    std::array<int, 12> nodes{};
    std::array<double, 12> weights{};
    Vec3 position; ///< [m] at the start of the step
    Vec3 velocity; ///< [m/s] at the start of the step; where nothing can change it, throughout

    void add(int node, double weight);
};

/// Two points that touch, or hold each other, and what the law between them says. u is the velocity of the first
/// against the second, in the frame.
struct Link {
    std::array<BodyPoint, 2> sides;
    std::array<Vec3, 3> frame; ///< unit and orthogonal; the first from the second side towards the first
    Vec3 bias;              ///< [m/s] in the frame: u + bias is to be >= 0 along the first (touching), or 0 (holding)
    double friction = -1.0; ///< [-] negative: holding
    double slack = 0.0;     ///< [m/s] how far from that u + bias may be
    double give = 0.0;      ///< [kg] of a spring; 0: rigid
    double most = std::numeric_limits<double>::infinity(); ///< [N s] of a joint: what it can bear along the first
    Vec3 impulse; ///< [N s] in the frame, on the first. In: of the last step; out: of this one
    Vec3 next;    ///< [N s] out: where the next step starts
};

} // namespace filasofia::engine
