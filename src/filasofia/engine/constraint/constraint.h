#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/engine/constraint/body_point.h"
#include "filasofia/math/mat3.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace filasofia::engine {

/// Contacts and joint limits are unilateral: they only push. Welds (attachments, grasps), springs and the dry friction
/// of joints are bilateral. A shaft in a channel is bilateral, with friction along its first axis; a tip only pushes.
/// The legs of a clip are springs between two points.
enum class ConstraintKind { Contact, Weld, JointLimit, JointFriction, JointSpring, Shaft, Tip, ClipLeg };

/// Identifies a contact from step to step, and holds the force that its next solve starts from.
struct CachedContact {
    BodyId first, second;
    std::uint64_t feature = 0; ///< the pair of features; the same from step to step (collision/proximity.h)
    Vec3 point;                ///< [m] in the world
    Vec3 force;                ///< [N] on the first body
    bool frictionLags = false; ///< whether its next solve begins with lagged friction (CoupledSolve)
};

/// The data of a constraint of kind Contact beyond its law.
struct ContactInfo {
    CachedContact cached;
    double gap = 0.0;       ///< [m] signed distance; negative if the surfaces overlap
    double proximity = 0.0; ///< [m] sum of both surfaces' proximities
    double skin = 0.0;      ///< [m] the gap that the contact keeps
    double turning = 0.0;   ///< [m] change of the gap in the step beyond that by the velocity at its start
    Vec3 sliding = {};      ///< [m/s] the same of the first side's place on the second, as a velocity; world axes
    bool passing = false;   ///< of this step alone, as what keeps lines from passing: the next starts without it
    bool parting = false;   ///< leads surfaces out of each other: its gap is no distance
};

/// The data of a constraint of kind JointLimit, JointFriction or JointSpring beyond its law.
struct JointInfo {
    std::size_t articulation = 0; ///< index among the articulation plans
    int joint = 0;
    double arm = 1.0;   ///< [m] the constraint's velocity is the joint's times this; 1 for a prismatic joint
    bool upper = false; ///< JointLimit: true for the upper limit
};

/// The data of a constraint of kind Shaft or Tip beyond its law.
struct ChannelInfo {
    static constexpr int kTip = -1;
    std::size_t channel = 0; ///< index in SceneState::channels
    int point = kTip;        ///< index of its point
};

/// What a solve needs of a constraint in every iteration:
///
///     C = bias + u,   u = F J (v + dv)
///
///     J      the velocity of the first point relative to the second, from the bodies' unknowns (ConstraintRow)
///     F      the frame's three rows; the first is the normal
///     v, dv  [m/s] the bodies' velocities, and their change in this step
///
/// A unilateral constraint requires C >= 0 along the normal: its normal impulse n only pushes, and its tangential
/// impulse t is within Coulomb's cone |t| <= friction * n. A bilateral constraint requires C = 0 in all three rows, but
/// applies at most maxImpulse along the first. A shaft requires C = 0 across its first axis, the line; along it, its
/// impulse is bounded by maxImpulse, dry friction. The legs of a clip are a spring along the normal, whose tension
/// resists what moves its ends across it.
struct ConstraintLaw {
    ConstraintKind kind = ConstraintKind::Contact;
    std::array<Vec3, 3> frame = {}; ///< orthonormal; the first vector is the normal, from the second side to the first
    Vec3 bias = {};                 ///< [m/s] in the frame
    double friction = 0.0;          ///< [-] Coulomb's mu; unilateral constraints only
    double tolerance = 0.0;         ///< [m/s] how far a rigid constraint may miss C = 0 (or C >= 0)
    double softness = 0.0;          ///< [kg] impulse per velocity of a spring; 0 if the constraint is rigid
    double across = 1.0;            ///< [-] ClipLeg, Shaft: stiffness across the first axis, relative to that along it
    /// [N s] Bound on the impulse along the normal. The constraint yields beyond it.
    double maxImpulse = std::numeric_limits<double>::infinity();
    /// [N s] in the frame, on the first side. In: the last step's impulse; out: the impulse that acted in this step
    Vec3 impulse = {};

    [[nodiscard]] bool bilateral() const
    {
        return kind == ConstraintKind::Weld || kind == ConstraintKind::JointFriction ||
               kind == ConstraintKind::JointSpring || kind == ConstraintKind::Shaft || kind == ConstraintKind::ClipLeg;
    }
};

/// Two points and the law between them: a contact, a pair of points of an attachment, a joint limit, a joint's
/// friction or spring, a shaft in a channel or its tip, two points that a clip draws together.
struct Constraint : ConstraintLaw {
    std::array<BodyPoint, 2> sides = {};
    double yielding = 1.0; ///< [-] factor on the penalty of a rigid constraint, > 0
    /// If only one side can move along the normal, as between a body and a kinematic one: another such factor, in
    /// (0, 1], and the fraction that the carried normal impulse loses; both for kRigidKappa.
    double trappedYielding = 1.0, trappedLoss = 0.0;
    double lostLoss = 0.0; ///< [-] the same fraction if both can move: they are inside each other
    Vec3 multiplier = {};  ///< [N s] out: multiplier of the augmented Lagrangian, from which the next step starts

    bool tied = false; ///< the coarse levels know it from step to step (TiedCoarse)

    ContactInfo contact = {}; ///< kind Contact only
    JointInfo joint = {};     ///< kinds JointLimit, JointFriction and JointSpring only
    ChannelInfo channel = {}; ///< kinds Shaft and Tip only
};

/// Index of a contact point among all bodies' contact points of a solve, and its weight in J.
struct WeightedPoint {
    int point = 0;
    double weight = 0.0;
};

/// A constraint's rows of J: the contact points that it acts on.
struct ConstraintRow {
    Constraint* constraint = nullptr;
    int first = 0, count = 0;       ///< range of its points in ConstraintRows::points
    std::array<int, 2> pieces = {}; ///< per side: the piece that it acts on, if the body has fallen into pieces
};

/// The constraints of one coupled solve. Refers to the constraints; the solve writes their impulses in place.
struct ConstraintRows {
    std::vector<ConstraintRow> list;
    std::vector<WeightedPoint> points;
    void clear()
    {
        list.clear();
        points.clear();
    }
    [[nodiscard]] std::span<const WeightedPoint> pointsOf(const ConstraintRow& row) const
    {
        return std::span(points).subspan(static_cast<std::size_t>(row.first), static_cast<std::size_t>(row.count));
    }
};

/// Adds J^T impulse to the contact points of row `c`; `impulse` [N s], world axes.
inline void addImpulse(const ConstraintRows& rows, std::size_t c, Vec3 impulse, std::span<Vec3> atPoints)
{
    for (const WeightedPoint& each : rows.pointsOf(rows.list[c]))
        atPoints[static_cast<std::size_t>(each.point)] += each.weight * impulse;
}

/// Returns the unit normal and two tangents. Continuous but for two places on the sphere of normals.
std::array<Vec3, 3> frameOf(Vec3 normal);
inline Mat3 asMatrix(const std::array<Vec3, 3>& f) { return {{f[0], f[1], f[2]}}; } ///< F
/// A vector's components along a frame's rows, and back.
inline Vec3 inFrame(const std::array<Vec3, 3>& f, Vec3 v) { return {dot(f[0], v), dot(f[1], v), dot(f[2], v)}; }
inline Vec3 inWorld(const std::array<Vec3, 3>& f, Vec3 v) { return v.x * f[0] + v.y * f[1] + v.z * f[2]; }

/// Multiplies entry by entry.
inline Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

/// An impulse y [N s] projected onto the constraint law. Unilateral: zero if y pulls, otherwise y with its tangential
/// part scaled back to the friction cone. Bilateral: y itself. Both are bounded by maxImpulse.
struct Projected {
    Vec3 impulse;
    /// [-] in [0, 1]: the fraction of the stiffness that is left where friction bounds the impulse. For a contact, the
    /// fraction of the tangential part; along a shaft, which has but one direction, 0 if it slides
    double slip = 0.0;
    bool active = false;
};
/// [N s] What friction bounds: the tangential impulse of a contact, the impulse along a shaft.
double coneOf(const ConstraintLaw& law, Vec3 impulse);
/// The fractions of the stiffness that are left, per axis of the frame; zeros unless the constraint is active.
Vec3 sharesOf(const ConstraintLaw& law, const Projected& state);
/// The impulse of the law that is linearised in a state: what touches stays, and so does what slides.
Vec3 linearised(const ConstraintLaw& law, const Projected& state, Vec3 y);
/// Projects onto Coulomb's cone, whose radius follows from the impulse.
Projected project(const ConstraintLaw& law, Vec3 y);
/// Projects onto a cone of fixed radius `cone` [N s] (Tresca's law), whatever the impulse is.
Projected project(const ConstraintLaw& law, Vec3 y, double cone);

} // namespace filasofia::engine
