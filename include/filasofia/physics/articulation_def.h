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

/// Joints: what an instrument with moving parts is made of.
namespace filasofia::physics {

enum class JointKind {
    Revolute, ///< turns about its axis [rad]
    Prismatic ///< slides along it [m]
};

/// Its values' names in files, in their order.
constexpr std::array<std::string_view, 2> names(const JointKind*) { return {"revolute", "prismatic"}; }

/// The joint goes there, at its `speed` at most, whatever is in its way.
struct JointPosition {
    double value = 0.0; ///< [rad] or [m], within the joint's limits
};
/// The joint is pushed along its axis and moves by the masses of its links: contacts hold it up.
struct JointForce {
    double value = 0.0; ///< [N m] of a revolute joint, [N] of a prismatic one
};
using JointCommand = std::variant<JointPosition, JointForce>;

/// One link of the tree hangs on another and can move against it in one way. With q the joint's position,
///
///     child = parent * parentOffset * M(q) * inverse(childOffset),   M(q) the turn about the axis, or the way along
///     it.
struct JointDef {
    JointKind kind = JointKind::Revolute;
    Vec3 axis = {0.0, 0.0, 1.0};                             ///< any length > 0, in the joint's frame
    int parent = 0;                                          ///< [-], in [0, links): the element that it is fixed to
    int child = 1;                                           ///< [-], in [1, links): the element that it moves
    Pose parentOffset = {};                                  ///< the joint's frame, in the parent's coordinates
    Pose childOffset = {};                                   ///< the joint's frame, in the child's coordinates
    double lower = -std::numeric_limits<double>::infinity(); ///< [rad] or [m], may be infinite: a stop
    double upper = std::numeric_limits<double>::infinity();  ///< [rad] or [m], >= lower: the other
    double start = 0.0;                                      ///< [rad] or [m], within the limits
    std::optional<JointCommand> command = {}; ///< until changed by a command; none: it stays where it starts
    double speed = 3.0;                       ///< [rad/s] or [m/s], > 0, at most, on the way to a commanded position
    double damping = 0.0;  ///< [N m s] or [N s/m], >= 0, of a joint that a force commands, against its velocity
    double friction = 0.0; ///< [N m] or [N], >= 0, of such a joint: dry, holds it up to this
    double inertia = 0.0;  ///< [kg m^2] or [kg], >= 0, of the drive behind it, besides what it moves
    std::optional<GivenInertia> mass = {}; ///< of the child; none: that of every element of the body
};

/// A tree of links that drives the elements of one rigid body. Element i is link i; element 0, the base, goes where it
/// is told (setPose), or with an element of another body, or, of a dynamic body, where forces move it.
struct ArticulationDef {
    std::vector<JointDef> joints =
        {};            ///< one for each link but the base; none: the elements know nothing of each other
    BodyId to = {};    ///< a rigid body that goes where it is told, and takes the base along; none: none
    int toElement = 0; ///< [-], in [0, elements of `to`); 0 where `to` has joints itself: its base
    Pose offset = {};  ///< the base, in the coordinates of that element
};

constexpr auto fields(const JointPosition*)
{
    return describe("JointPosition", field("value", &JointPosition::value, "rad or m", finite(), "where it goes"));
}
constexpr auto fields(const JointForce*)
{
    return describe("JointForce", field("value", &JointForce::value, "N m or N", finite(), "what pushes it"));
}
constexpr auto fields(const JointDef*)
{
    using T = JointDef;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return describe("JointDef", field("kind", &T::kind, "turns or slides"),
                    field("axis", &T::axis, "-", finite(), "in the joint's frame, of any length"),
                    field("parent", &T::parent, "-", nonNegative(), "the element that it is fixed to"),
                    field("child", &T::child, "-", nonNegative(), "the element that it moves"),
                    field("parentOffset", &T::parentOffset, "the joint's frame, in the parent's coordinates"),
                    field("childOffset", &T::childOffset, "the joint's frame, in the child's coordinates"),
                    field("lower", &T::lower, "rad or m", closed(-infinity, infinity), "its stop"),
                    field("upper", &T::upper, "rad or m", closed(-infinity, infinity), "its other stop"),
                    field("start", &T::start, "rad or m", finite(), "where it is at the start"),
                    field("command", &T::command, "at the start; none: it stays"),
                    field("speed", &T::speed, "rad/s or m/s", positive(), "at most, to a commanded position"),
                    field("damping", &T::damping, "N m s or N s/m", nonNegative(), "against its velocity"),
                    field("friction", &T::friction, "N m or N", nonNegative(), "dry"),
                    field("inertia", &T::inertia, "kg m^2 or kg", nonNegative(), "of the drive behind it"),
                    field("mass", &T::mass, "of the child; none: of every element"));
}
constexpr auto fields(const ArticulationDef*)
{
    using T = ArticulationDef;
    return describe("ArticulationDef", field("joints", &T::joints, "one for each element but the first"),
                    field("to", &T::to, "the body that takes the base along; none: it is told"),
                    field("toElement", &T::toElement, "-", nonNegative(), "of `to`"),
                    field("offset", &T::offset, "the base, in that element's coordinates"));
}

} // namespace filasofia::physics
