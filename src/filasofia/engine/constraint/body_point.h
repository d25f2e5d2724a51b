#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <cstddef>

namespace filasofia::engine {

/// A point of a body, or of space, where a constraint acts.
struct BodyPoint {
    enum class Of { Space, Soft, Rigid, Joint };
    Of of = Of::Space;
    std::size_t body = 0; ///< index among the soft bodies, or in the rigid plan; for a joint: its body's base there
    int joint = 0;        ///< Joint: its velocity is along x, times a length (JointInfo::arm)
    int count = 0;        ///< Soft: the number of nodes that it is a weighted mean of, at most twelve
    std::array<int, 12> nodes{};
    std::array<double, 12> weights{};
    Vec3 position; ///< [m] at the start of the step
    Vec3 velocity; ///< [m/s] at the start of the step; if nothing can change it, throughout

    void add(int node, double weight);
};

} // namespace filasofia::engine
