#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/core/fields.h"
#include "filasofia/geometry/box.h"
#include "filasofia/physics/mouth.h"

#include <array>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

namespace filasofia::physics {

inline constexpr double kHard = std::numeric_limits<double>::infinity();
inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// A ball that selects nodes.
struct Ball {
    Vec3 centre = {};     ///< [m], finite, in the world
    double radius = 1e-2; ///< [m], > 0

    friend bool operator==(const Ball&, const Ball&) = default;
};

/// The point of another soft body that a node is attached to.
enum class AttachMode {
    /// Its nearest node; the attachment pulls the two together. The nearest of several nodes with the same one is held.
    Nearest,
    Barycentric ///< the current position of the node, as a weighted mean of the nodes around it
};

/// The enumerators' names in files, in their order.
constexpr std::array<std::string_view, 2> names(const AttachMode*) { return {"nearest", "barycentric"}; }

/// Attaches nodes of a soft body to their current positions in space, or to another body.
struct AttachmentDef {
    std::vector<int> nodes = {}; ///< [-], in [0, nodes of the body's mesh): selected nodes
    std::optional<geometry::Box> box =
        {};                        ///< [m], high >= low: also selects every node that is now in this box of the world
    std::optional<Ball> ball = {}; ///< also selects every node that is now in this ball of the world
    /// [m], >= 0: also selects every node that is now this near to the surface of `to`, or inside it. Only with a body
    /// `to`; if `to` is set and nothing is selected: 1 % of its size
    std::optional<double> within = {};
    double stiffness = kHard; ///< [N/m], in (0, inf], of each node's spring; infinite: an equality constraint
    BodyId to = {};           ///< the body that the nodes are attached to; none: they are attached to space
    int element = 0;          ///< [-], in [0, elements of `to`) if `to` is rigid; otherwise 0
    AttachMode mode = AttachMode::Barycentric; ///< the point of `to` that each node is attached to, if `to` is soft
    double breakForce = kNever; ///< [N], in (0, inf]: the attachment breaks if the sum of its nodes' forces is larger
    /// [-], each in [0, nodes of the mesh of `to`): pairs of nodes, nodes[i] is drawn to toNodes[i]. If given: as many
    /// as `nodes`, `to` is soft, box, ball and within are empty, and the mode does not matter
    std::vector<int> toNodes = {};
    /// [N], in (0, inf]: a point lets go by itself if its force is larger: tissue that is torn off its bed. Needs a
    /// body `to`; not for rods
    double pointBreakForce = kNever;
    /// [m], >= 0: a blade that may cut one of the two bodies parts the points that its path comes this near to: a
    /// connecting layer that is dissected. 0: blades part nothing. Needs a body `to`; not for rods
    double cutDistance = 0.0;
};

/// Attaches a rigid element to its current pose in space, or to another body.
struct RigidAttachmentDef {
    int element = 0; ///< [-], in [0, elements of this body)
    /// [m], each < 10 km from the element's origin, in its coordinates: each point is attached; none: the element as a
    /// whole, with its position and its orientation
    std::vector<Vec3> points = {};
    double stiffness = kHard;   ///< [N/m], in (0, inf], of each point's spring; infinite: an equality constraint
    BodyId to = {};             ///< the body that it is attached to; none: it is attached to space
    int toElement = 0;          ///< [-], in [0, elements of `to`) if `to` is rigid; otherwise 0
    double breakForce = kNever; ///< [N], in (0, inf]: the attachment breaks if the sum of its points' forces is larger
};

/// Attaches a rigid body to what it touches of another body, as if glued at the contact points: a grasp that cannot
/// slip.
struct GraspDef {
    double stiffness = kHard;   ///< [N/m], in (0, inf], of each contact's spring; infinite: an equality constraint
    double breakForce = kNever; ///< [N], in (0, inf]: the grasp breaks if the sum of its contacts' forces is larger
    /// Only what touches the body there is grasped; not given: whatever touches it. Instruments with jaws give theirs.
    std::optional<Mouth> mouth = {};
};

constexpr auto fields(const Ball*)
{
    return describe("Ball", field("centre", &Ball::centre, "m", finite(), "centre of the ball"),
                    field("radius", &Ball::radius, "m", positive(), "radius of the ball"));
}
constexpr auto fields(const AttachmentDef*)
{
    using T = AttachmentDef;
    return describe("AttachmentDef",
                    field("nodes", &T::nodes, "-", nonNegative(), "nodes of the body's mesh that are attached"),
                    field("box", &T::box, "also attaches the nodes that are now in this box of the world"),
                    field("ball", &T::ball, "also attaches the nodes that are now in this ball of the world"),
                    field("within", &T::within, "m", nonNegative(),
                          "also attaches the nodes that are now this near to the surface of `to`"),
                    field("stiffness", &T::stiffness, "N/m", positiveOrInfinite(),
                          "stiffness of each node's spring; infinite: an equality constraint"),
                    field("to", &T::to, "the body that they are attached to; none: space"),
                    field("element", &T::element, "-", nonNegative(), "element of `to`, if that is rigid"),
                    field("mode", &T::mode, "point of `to` that each node is attached to, if `to` is soft"),
                    field("breakForce", &T::breakForce, "N", positiveOrInfinite(),
                          "the attachment breaks if the sum of its nodes' forces is larger"),
                    field("toNodes", &T::toNodes, "-", nonNegative(),
                          "nodes of the soft body `to`, one for each of `nodes`, to which those are drawn"),
                    field("pointBreakForce", &T::pointBreakForce, "N", positiveOrInfinite(),
                          "a point lets go by itself if its force is larger"),
                    field("cutDistance", &T::cutDistance, "m", nonNegative(),
                          "blades part the points that their path comes this near to; 0: none"));
}
constexpr std::size_t addedFields(const AttachmentDef*) { return 3; }
constexpr auto fields(const RigidAttachmentDef*)
{
    using T = RigidAttachmentDef;
    return describe("RigidAttachmentDef",
                    field("element", &T::element, "-", nonNegative(), "element of this body that is attached"),
                    field("points", &T::points, "m", finite(),
                          "attached points in the element's coordinates; none: the element as a whole"),
                    field("stiffness", &T::stiffness, "N/m", positiveOrInfinite(),
                          "stiffness of each point's spring; infinite: an equality constraint"),
                    field("to", &T::to, "the body that it is attached to; none: space"),
                    field("toElement", &T::toElement, "-", nonNegative(), "element of `to`, if that is rigid"),
                    field("breakForce", &T::breakForce, "N", positiveOrInfinite(),
                          "the attachment breaks if the sum of its points' forces is larger"));
}
constexpr auto fields(const GraspDef*)
{
    using T = GraspDef;
    return describe("GraspDef",
                    field("stiffness", &T::stiffness, "N/m", positiveOrInfinite(),
                          "stiffness of each contact's spring; infinite: an equality constraint"),
                    field("breakForce", &T::breakForce, "N", positiveOrInfinite(),
                          "the grasp breaks if the sum of its contacts' forces is larger"),
                    field("mouth", &T::mouth, "only what touches the body there is grasped"));
}
constexpr std::size_t addedFields(const GraspDef*) { return 1; }

} // namespace filasofia::physics
