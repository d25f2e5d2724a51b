#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/engine/constraint/body_point.h"
#include "filasofia/math/vec3.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace filasofia::engine {

/// What two points want of each other. Contacts and joint limits are unilateral: they push only. Welds (attachments,
/// grasps) and the dry friction of joints are bilateral.
enum class ConstraintKind { Contact, Weld, JointLimit, JointFriction };

/// Which contact this is, from step to step, and the force that its next solve starts from.
struct CachedContact {
    BodyId first, second;
    std::uint64_t feature = 0; ///< the pair of features, the same from step to step (collision/proximity.h)
    Vec3 point;                ///< [m] in the world
    Vec3 force;                ///< [N] on the first
};

/// What a constraint of kind Contact is besides its law.
struct ContactInfo {
    CachedContact cached;
    double gap = 0.0;       ///< [m] negative inside each other
    double proximity = 0.0; ///< [m] of both surfaces together
    double skin = 0.0;      ///< [m] the gap that the contact is to keep
};

/// What a constraint of kind JointLimit or JointFriction is besides its law.
struct JointInfo {
    std::size_t articulation = 0; ///< index among the articulation plans
    int joint = 0;
    double arm = 1.0;   ///< [m] the constraint's velocity is the joint's times this; 1 for a prismatic joint
    bool upper = false; ///< JointLimit: the upper one
};

/// Two points and the law between them: a contact, a pair of an attachment, a limit or the friction of a joint. With
///
///     J   the velocity of the first point against the second, as the bodies' unknowns give it (ConstraintRow)
///     F   the frame's three rows,     u = F J (v + dv)
///
/// a unilateral constraint wants bias + u >= 0 along the normal, with an impulse there that only pushes, and a
/// tangential impulse within Coulomb's cone |t| <= friction * n. A bilateral one wants bias + u = 0 in all three rows,
/// but no more than maxImpulse along the first.
struct Constraint {
    ConstraintKind kind = ConstraintKind::Contact;
    std::array<BodyPoint, 2> sides = {};
    std::array<Vec3, 3> frame = {}; ///< unit and orthogonal; the first is the normal, from the second side to the first
    Vec3 bias = {};                 ///< [m/s] in the frame
    double friction = 0.0;          ///< [-] Coulomb's mu; unilateral constraints only
    double tolerance = 0.0;         ///< [m/s] how far a rigid constraint may end from what it wants
    double softness = 0.0;          ///< [kg] impulse per velocity of a spring; 0: rigid
    double maxImpulse = std::numeric_limits<double>::infinity(); ///< [N s] along the normal; beyond, it gives way
    Vec3 impulse = {};    ///< [N s] in the frame, on the first side. In: the last step's; out: what acted in this step
    Vec3 multiplier = {}; ///< [N s] out: the augmented Lagrangian's multiplier, where the next step starts

    ContactInfo contact = {}; ///< kind Contact only
    JointInfo joint = {};     ///< kinds JointLimit and JointFriction only

    [[nodiscard]] bool bilateral() const
    {
        return kind == ConstraintKind::Weld || kind == ConstraintKind::JointFriction;
    }
};

/// A contact point among all bodies' contact points of a solve, and its weight in J.
struct WeightedPoint {
    int point = 0;
    double weight = 0.0;
};

/// A constraint's rows of J: which contact points it acts on.
struct ConstraintRow {
    Constraint* constraint = nullptr;
    int first = 0, count = 0;       ///< its points in ConstraintRows::points
    std::array<int, 2> pieces = {}; ///< per side: the piece that it acts on, if the body has fallen into pieces
};

/// The constraints of one coupled solve. The constraints themselves stay where they are, and get their impulses there.
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

/// Adds J^T F^T impulse to the contact points of row `c`; `impulse` [N s] in the constraint's frame.
void addImpulse(const ConstraintRows& rows, std::size_t c, Vec3 impulse, std::span<Vec3> atPoints);

/// A unit normal and two tangents. Continuous but for two places on the sphere.
std::array<Vec3, 3> frameOf(Vec3 normal);
/// A vector's components along a frame's rows, and back.
inline Vec3 inFrame(const std::array<Vec3, 3>& f, Vec3 v) { return {dot(f[0], v), dot(f[1], v), dot(f[2], v)}; }
inline Vec3 inWorld(const std::array<Vec3, 3>& f, Vec3 v) { return v.x * f[0] + v.y * f[1] + v.z * f[2]; }

/// Entry by entry.
inline Vec3 times(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

/// The impulse that the law allows nearest to y [N s]: none if it would pull, else projected onto the friction cone; y
/// itself if bilateral.
struct Projected {
    Vec3 impulse;
    double slip = 0.0; ///< [-] in [0, 1]: how much of the tangential part is left
    bool active = false;
};
/// Coulomb's law is applied here.
Projected project(const Constraint& constraint, Vec3 y);
/// The same for a cone of fixed radius `cone` [N s] (Tresca's law), whatever the normal impulse is.
Projected project(const Constraint& constraint, Vec3 y, double cone);

} // namespace filasofia::engine
