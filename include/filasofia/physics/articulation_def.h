#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/math/pose.h"
#include "filasofia/physics/mass_def.h"

#include <array>
#include <limits>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

/// Joints, which connect the links of an instrument with moving parts.
namespace filasofia::physics {

enum class JointKind {
    Revolute, ///< rotates about its axis [rad]
    Prismatic ///< slides along its axis [m]
};

/// The enumerators' names in files, in their order.
constexpr std::array<std::string_view, 2> names(const JointKind*) { return {"revolute", "prismatic"}; }

/// The joint moves to a position at no more than its `speed`, whatever is in its way (its motion is prescribed).
struct JointPosition {
    double value = 0.0; ///< [rad] or [m], within the joint's limits
};
/// A force acts on the joint along or about its axis; the inertia of its links and contacts determine its motion.
struct JointForce {
    double value = 0.0; ///< torque [N m] for a revolute joint, force [N] for a prismatic one
};
/// A spring and a damper draw the joint towards a position with bounded force, as a motor under PD control does: with
/// the joint's position q, the force is stiffness * (value - q) - damping * q', at most strength. It is implicit, and
/// so it adds no energy, however stiff it is.
struct JointSpring {
    double value = 0.0;     ///< [rad] or [m], in [-1e6, 1e6], may be beyond the joint's limits
    double stiffness = 1.0; ///< [N m/rad] or [N/m], >= 0
    double damping = 0.0;   ///< [N m s] or [N s/m], >= 0
    double strength = std::numeric_limits<double>::infinity(); ///< [N m] or [N], >= 0, may be infinite: largest force
};
using JointCommand = std::variant<JointPosition, JointForce, JointSpring>;
/// Whether forces move a joint under this command, and not the command itself.
inline bool isByForce(const JointCommand& command) { return !std::holds_alternative<JointPosition>(command); }

/// One joint goes with another one, as by gears: with q the other's position, it is at multiplier * q + offset. What
/// pushes on it pushes the other one, whose limits are narrowed to keep it within its own, and its damping, friction
/// and inertia resist both. Its `speed` does not count.
struct JointMimic {
    int joint = 0;           ///< [-], in [0, joints): the other one, which has no mimic itself
    double multiplier = 1.0; ///< [-] or rad/m or m/rad, in [-1e6, 1e6]
    double offset = 0.0;     ///< [rad] or [m], in [-1e6, 1e6]
};

/// One link of the tree is connected to another and has one degree of freedom relative to it. With q the joint's
/// position,
///
///     child = parent * parentOffset * M(q) * inverse(childOffset),
///
/// where M(q) is the rotation about the axis or the translation along it.
struct JointDef {
    JointKind kind = JointKind::Revolute;
    Vec3 axis = {0.0, 0.0, 1.0};                             ///< any length > 0, in the joint's frame
    int parent = 0;                                          ///< [-], in [0, links): the element that it is attached to
    int child = 1;                                           ///< [-], in [1, links): the element that it moves
    Pose parentOffset = {};                                  ///< the joint's frame, in the parent's coordinates
    Pose childOffset = {};                                   ///< the joint's frame, in the child's coordinates
    double lower = -std::numeric_limits<double>::infinity(); ///< [rad] or [m], may be infinite: lower limit
    double upper = std::numeric_limits<double>::infinity();  ///< [rad] or [m], >= lower: upper limit
    /// [rad] or [m], within the limits: initial position; 0 with a mimic, whose start is that of the other joint
    double start = 0.0;
    double velocity = 0.0; ///< [rad/s] or [m/s], initial, of a joint that forces move
    std::optional<JointCommand> command =
        {};                ///< valid until changed by a command; none: the joint keeps its initial position
    double speed = 3.0;    ///< [rad/s] or [m/s], > 0, largest speed on the way to a commanded position
    double damping = 0.0;  ///< [N m s] or [N s/m], >= 0, viscous, for a joint that forces move
    double friction = 0.0; ///< [N m] or [N], >= 0, dry friction, for a joint that forces move
    double inertia = 0.0;  ///< [kg m^2] or [kg], >= 0, of the drive, in addition to the links that it moves
    std::optional<GivenInertia> mass = {}; ///< mass of the child; none: that of every element of the body
    std::optional<JointMimic> mimic = {};  ///< in place of a command: the joint that it follows
};

/// A tree of links that moves the elements of one rigid body. Element i is link i. Element 0, the base, is kinematic
/// (setPose), or follows an element of another body, or, if the body is dynamic, moves under forces.
struct ArticulationDef {
    /// One per link except the base; if empty, the elements are independent of each other.
    std::vector<JointDef> joints = {};
    BodyId to = {};    ///< a kinematic rigid body whose element the base follows; none: it follows no body
    int toElement = 0; ///< [-], in [0, elements of `to`); 0 if `to` has joints itself: its base
    Pose offset = {};  ///< pose of the base in the coordinates of that element
};

constexpr auto fields(const JointPosition*)
{
    return describe("JointPosition",
                    field("value", &JointPosition::value, "rad or m", finite(), "position to move to"));
}
constexpr auto fields(const JointForce*)
{
    return describe("JointForce",
                    field("value", &JointForce::value, "N m or N", finite(), "force or torque of the drive"));
}
constexpr auto fields(const JointSpring*)
{
    using T = JointSpring;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return describe("JointSpring",
                    field("value", &T::value, "rad or m", closed(-1e6, 1e6), "position that it is drawn to"),
                    field("stiffness", &T::stiffness, "N m/rad or N/m", nonNegative(), "of the spring"),
                    field("damping", &T::damping, "N m s or N s/m", nonNegative(), "of the damper"),
                    field("strength", &T::strength, "N m or N", closed(0.0, infinity), "largest force of both"));
}
constexpr auto fields(const JointMimic*)
{
    using T = JointMimic;
    return describe("JointMimic", field("joint", &T::joint, "-", nonNegative(), "the joint that it follows"),
                    field("multiplier", &T::multiplier, "-", closed(-1e6, 1e6), "its way per way of the other"),
                    field("offset", &T::offset, "rad or m", closed(-1e6, 1e6), "where it is if the other is at 0"));
}
constexpr auto fields(const JointDef*)
{
    using T = JointDef;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return describe(
        "JointDef", field("kind", &T::kind, "revolute or prismatic"),
        field("axis", &T::axis, "-", finite(), "axis in the joint's frame, of any length"),
        field("parent", &T::parent, "-", nonNegative(), "the element that it is attached to"),
        field("child", &T::child, "-", nonNegative(), "the element that it moves"),
        field("parentOffset", &T::parentOffset, "the joint's frame, in the parent's coordinates"),
        field("childOffset", &T::childOffset, "the joint's frame, in the child's coordinates"),
        field("lower", &T::lower, "rad or m", closed(-infinity, infinity), "lower limit"),
        field("upper", &T::upper, "rad or m", closed(-infinity, infinity), "upper limit"),
        field("start", &T::start, "rad or m", finite(), "initial position"),
        field("velocity", &T::velocity, "rad/s or m/s", finite(), "initial velocity, of a joint that forces move"),
        field("command", &T::command, "initial command; none: it keeps its initial position"),
        field("speed", &T::speed, "rad/s or m/s", positive(), "largest speed on the way to a commanded position"),
        field("damping", &T::damping, "N m s or N s/m", nonNegative(), "viscous damping"),
        field("friction", &T::friction, "N m or N", nonNegative(), "dry friction"),
        field("inertia", &T::inertia, "kg m^2 or kg", nonNegative(), "inertia of the drive"),
        field("mass", &T::mass, "mass of the child; none: that of every element"),
        field("mimic", &T::mimic, "the joint that it follows, in place of a command"));
}
constexpr auto fields(const ArticulationDef*)
{
    using T = ArticulationDef;
    return describe("ArticulationDef", field("joints", &T::joints, "one for each element except the first"),
                    field("to", &T::to, "the body that the base follows; none: it follows no body"),
                    field("toElement", &T::toElement, "-", nonNegative(), "element of `to` that the base follows"),
                    field("offset", &T::offset, "pose of the base in that element's coordinates"));
}

} // namespace filasofia::physics
