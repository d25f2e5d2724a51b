#pragma once

#include "filasofia/math/vec3.h"

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace filasofia::engine {

/// A grip that a constraint takes hold of, and how much of it counts.
struct WeightedGrip {
    int grip = 0; ///< of all bodies' grips, one list
    double weight = 0.0;
};

/// What three velocities of a few grips must obey: a contact, or a point that is held.
///
///     u = F (sum of weight * velocity - obstacle),   F the frame's three rows
///
/// A contact wants bias + u >= 0 along the normal, with an impulse there that pushes only, and a tangential impulse
/// within Coulomb's cone. What is held wants bias + u = 0 in all three.
struct Constraint {
    int first = 0, count = 0;       ///< its grips in the list of WeightedGrip
    Vec3 point;                     ///< [m] where it is, of all constraints from the same origin
    std::array<Vec3, 3> frame;      ///< unit and orthogonal; the normal first
    std::array<int, 2> pieces = {}; ///< per side, of a body that has fallen into pieces: the one that it is at
    Vec3 start;                     ///< [m/s] u before the step changes any velocity
    Vec3 bias;                      ///< [m/s]
    double friction = -1.0;         ///< [-] mu; negative: held
    double slack = 0.0;             ///< [m/s] of a rigid one: how far from what it wants bias + u may be at the end
    double give = 0.0;              ///< [kg] of a spring: impulse per velocity; 0: rigid
    /// [N s] that it bears along its first axis, where that is all that it has to say, as of a joint: beyond, it
    /// slides.
    double most = std::numeric_limits<double>::infinity();
    Vec3 impulse; ///< [N s] in the frame. In: of the last step; out: what acted in this one
    Vec3 next;    ///< [N s] out: where the next step starts
};

/// Some constraints, and the grips that they take hold of.
struct Constraints {
    std::vector<Constraint> list;
    std::vector<WeightedGrip> grips;
    void clear()
    {
        list.clear();
        grips.clear();
    }
};

/// Adds an impulse in the frame of constraint c to its grips: J^T F^T.
void giveImpulse(const Constraints& constraints, std::size_t c, Vec3 impulse, std::span<Vec3> atGrips);

/// Two tangents for a unit normal. Continuous but for two places on the ball.
std::array<Vec3, 3> frameOf(Vec3 normal);
/// A vector's parts along a frame's rows, and back.
inline Vec3 inFrame(const std::array<Vec3, 3>& f, Vec3 v) { return {dot(f[0], v), dot(f[1], v), dot(f[2], v)}; }
inline Vec3 inWorld(const std::array<Vec3, 3>& f, Vec3 v) { return v.x * f[0] + v.y * f[1] + v.z * f[2]; }

/// Entry by entry.
inline Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

/// The impulse that the law allows nearest to y: none where it would pull, in the cone of friction otherwise; y itself
/// of what is held. `slip` in [0, 1]: how much of the tangential part is left.
struct Projected {
    Vec3 impulse;
    double slip = 0.0;
    bool active = false;
};
Projected project(const Constraint& constraint, Vec3 y);
/// The same where a contact bears `cone` [N s] across, whatever its normal impulse is.
Projected project(const Constraint& constraint, Vec3 y, double cone);

} // namespace filasofia::engine
