#pragma once

#include "filasofia/engine/elastic/rod.h"
#include "filasofia/engine/elastic/spring.h"
#include "filasofia/physics/commands.h"
#include "filasofia/physics/rod_body_def.h"

#include <limits>
#include <span>
#include <string>
#include <vector>

namespace filasofia::engine {

/// What a rod consists of; empty for all other bodies. Edge i lies between the nodes i and i + 1, joint i between the
/// edges i and i + 1. A ring has as many edges and joints as nodes: after the last one comes the first.
struct Rod {
    double radius = 0.0;            ///< [m]
    bool needle = false;            ///< its first node is a sharp tip
    double bend = 0.0, twist = 0.0; ///< [N m^2] B and T
    /// [1/m] elastic curvature beyond which bending is plastic; infinite: never
    double yieldCurvature = std::numeric_limits<double>::infinity();
    double hardening = 0.0;               ///< [-], >= 0, RodYield::hardening
    std::vector<Spring> edges = {};       ///< what it resists stretching with
    std::vector<double> inertias = {};    ///< [kg m^2] per edge, about itself
    std::vector<RodJoint> joints = {};    ///< their stiffness follows from the pins: stiffJoint()
    std::vector<Vec3> directors = {};     ///< per edge, at the start
    std::vector<double> startTwists = {}; ///< [rad] per joint
    /// [rad] A ring is twisted by any angle before its ends are joined: by so much the material of its first edge is
    /// ahead of that of its last edge at the last joint
    double seam = 0.0;
    double breakForce = std::numeric_limits<double>::infinity(); ///< [N] tension beyond which an edge tears
    /// Per edge: it was cut or torn, or its piece was removed. It keeps its number and its mass, and bears nothing; nor
    /// do the joints beside it. Empty: none was
    std::vector<bool> cut = {};
    int pieces = 1; ///< how many pieces there ever were: the number of the next one
    /// Per edge: a hard attachment holds both nodes and the angle on a rigid body (findHeldEdges() in
    /// contact/attachments.h). Empty: none
    std::vector<bool> held = {};
};

/// The curvature that a joint is commanded [1/m]: towards the director of its edges, and towards edge x director.
struct RodSteering {
    std::array<double, 2> now{}, target{};
};

/// What a rod's state has beside its nodes.
struct RodState {
    std::vector<Vec3> directors; ///< per edge: a unit vector across it that turns with the material
    std::vector<double> spins;   ///< [rad/s] per edge: velocity of the material about it
    std::vector<double> twists;  ///< [rad] per joint, any number of turns
    /// [N] per edge: the force along it in the last step. That is what resists turning, and not the force that its
    /// length would make: a step moves nodes along straight lines, so every edge that turns has become longer.
    std::vector<double> tensions;
    std::vector<RodSteering> steering;                             ///< per joint; empty: nothing was ever commanded
    double steeringRate = std::numeric_limits<double>::infinity(); ///< [1/(m s)] > 0, by which it changes
    std::vector<RodCurvature> plastic; ///< [-] per joint: what has flowed is added to its rest; empty: it never yields
};

inline bool isRing(const Rod& rod) { return rod.edges.size() == rod.joints.size(); }
inline bool isCut(const Rod& rod, std::size_t edge) { return !rod.cut.empty() && rod.cut[edge]; }
inline bool canYield(const Rod& rod) { return rod.yieldCurvature < std::numeric_limits<double>::infinity(); }

/// A rod with these nodes at the start.
Rod makeRod(const physics::RodBodyDef& def, const std::vector<Vec3>& nodes);

/// The state at the start.
RodState stateAtStart(const Rod& rod);

/// A joint with its stiffness. An edge whose two nodes are pinned (`hard`, per node), or that is held, does not
/// deform, so a joint beside it has only the other half of its length: without that, a clamped rod would be half an
/// edge too long.
RodJoint stiffJoint(const Rod& rod, const std::vector<bool>& hard, std::size_t index);
std::vector<RodJoint> stiffJoints(const Rod& rod, const std::vector<bool>& hard); ///< all of them

/// A joint of stiffJoint() as it is now: its rest has what is commanded, and what has flowed.
RodJoint jointNow(const Rod& rod, const RodJoint& joint, const RodState& state, std::size_t index);

/// Sets what is commanded. At the border of a section a joint gets the share of its length that is in the section, so
/// that a section turns the rod by its curvature times its length, wherever nodes are.
void setCurvature(const physics::SetCurvature& command, const Rod& rod, RodState& state);

/// Moves the commanded curvature towards its target, once a step.
void steer(double dt, RodState& state);

/// Joints that are bent by more than the yield curvature get another curvature at rest: the plastic one follows.
void flow(const Rod& rod, const std::vector<bool>& hard, std::span<const Vec3> x, RodState& state);

/// Lists the edges that are cut, ascending.
void listCutEdges(const Rod& rod, std::vector<int>& out);

/// An index that goes on around a ring: i < 2 count. Without a division: it is asked for millions of times per second.
inline std::size_t wrapped(std::size_t i, std::size_t count) { return i < count ? i : i - count; }

/// Whether the material of an edge cannot turn about it: both its nodes are pinned.
inline bool clamped(const std::vector<bool>& hard, std::size_t edge)
{
    return hard[edge] && hard[wrapped(edge + 1, hard.size())];
}

/// The place of joint j.
RodPlace placeAt(const RodState& state, std::span<const Vec3> x, std::size_t joint);

/// Carries directors and twists along as the nodes move from one place to another and the material turns by
/// dt * spins. `seam` [rad]: Rod::seam. `out` may be the state.
void moveRod(double dt, std::span<const Vec3> from, std::span<const Vec3> to, double seam, const RodState& state,
             RodState& out);

/// Makes every director a unit vector across its edge, where someone moved the nodes without it.
void straighten(std::span<const Vec3> x, std::vector<Vec3>& directors);

/// Throws an Error that begins with `object` if a number or a size is invalid; the body has so many nodes.
void check(const Rod& rod, const RodState& state, std::size_t nodes, const std::string& object);

} // namespace filasofia::engine
