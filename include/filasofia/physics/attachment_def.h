#pragma once

#include "filasofia/core/body_id.h"
#include "filasofia/core/fields.h"
#include "filasofia/geometry/box.h"

#include <array>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

namespace filasofia::physics {

inline constexpr double kHard = std::numeric_limits<double>::infinity();
inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// The inside of a ball.
struct Ball {
    Vec3 centre = {};     ///< [m], finite, in the world
    double radius = 1e-2; ///< [m], > 0
};

/// What of another soft body a node is attached to.
enum class AttachMode {
    Nearest,    ///< its nearest node; the two are drawn together
    Barycentric ///< the place where the node is now, as a weighted mean of the nodes around that place
};

/// Its values' names in files, in their order.
constexpr std::array<std::string_view, 2> names(const AttachMode*) { return {"nearest", "barycentric"}; }

/// Holds nodes of a soft body: where they are in space, or on another body.
struct AttachmentDef {
    std::vector<int> nodes = {};           ///< [-], in [0, nodes of the body's mesh): these,
    std::optional<geometry::Box> box = {}; ///< [m], high >= low: and every node that is now in this box of the world,
    std::optional<Ball> ball = {};         ///< and every node that is now in this ball of the world,
    std::optional<double> within = {};     ///< [m], >= 0: and every node now so near to the surface of `to`, or inside
                                           ///< it. Only with a body `to`; with that and no region: 1 % of its size
    double stiffness = kHard; ///< [N/m], in (0, inf], of each node's spring; infinite: the node cannot leave
    BodyId to = {};           ///< another body, which holds them; none: they are held in space
    int element = 0;          ///< [-], in [0, elements of `to`), where `to` is rigid; else 0
    AttachMode mode = AttachMode::Barycentric; ///< at which place of `to` each is held, where `to` is soft
    double breakForce = kNever; ///< [N], in (0, inf]: it lets go when the sum of its nodes' forces is more
};

/// Holds a rigid element: where it is in space, or on another body.
struct RigidAttachmentDef {
    int element = 0;               ///< [-], in [0, elements of this body)
    std::vector<Vec3> points = {}; ///< [m], each < 10 km from the element's origin, in its coordinates: each is held;
                                   ///< none: the element as a whole, its place and its orientation
    double stiffness = kHard;      ///< [N/m], in (0, inf], of each point's spring; infinite: the point cannot leave
    BodyId to = {};                ///< another body, which holds it; none: it is held in space
    int toElement = 0;             ///< [-], in [0, elements of `to`), where `to` is rigid; else 0
    double breakForce = kNever;    ///< [N], in (0, inf]: it lets go when the sum of its points' forces is more
};

/// Ties what a rigid body touches of another to it, as if they were glued where they touch: a grip that cannot slip.
struct GraspDef {
    double stiffness = kHard;   ///< [N/m], in (0, inf], of each contact's spring; infinite: it cannot leave
    double breakForce = kNever; ///< [N], in (0, inf]: it lets go when the sum of its contacts' forces is more
};

constexpr auto fields(const Ball*)
{
    return describe("Ball", field("centre", &Ball::centre, "m", finite(), "its middle"),
                    field("radius", &Ball::radius, "m", positive(), "from its middle to its surface"));
}
constexpr auto fields(const AttachmentDef*)
{
    using T = AttachmentDef;
    return describe("AttachmentDef",
                    field("nodes", &T::nodes, "-", nonNegative(), "nodes that are held, of the body's mesh"),
                    field("box", &T::box, "and the nodes that are in this box of the world now"),
                    field("ball", &T::ball, "and the nodes that are in this ball of the world now"),
                    field("within", &T::within, "m", nonNegative(), "and the nodes so near to the surface of `to` now"),
                    field("stiffness", &T::stiffness, "N/m", positiveOrInfinite(), "of each node's spring"),
                    field("to", &T::to, "the body that holds them; none: space"),
                    field("element", &T::element, "-", nonNegative(), "of `to`, where that is rigid"),
                    field("mode", &T::mode, "at which place of `to`, where that is soft"),
                    field("breakForce", &T::breakForce, "N", positiveOrInfinite(),
                          "the sum of its nodes' forces beyond which it lets go"));
}
constexpr auto fields(const RigidAttachmentDef*)
{
    using T = RigidAttachmentDef;
    return describe("RigidAttachmentDef", field("element", &T::element, "-", nonNegative(), "of this body"),
                    field("points", &T::points, "m", finite(), "held, in its coordinates; none: all of it"),
                    field("stiffness", &T::stiffness, "N/m", positiveOrInfinite(), "of each point's spring"),
                    field("to", &T::to, "the body that holds it; none: space"),
                    field("toElement", &T::toElement, "-", nonNegative(), "of `to`, where that is rigid"),
                    field("breakForce", &T::breakForce, "N", positiveOrInfinite(),
                          "the sum of its points' forces beyond which it lets go"));
}
constexpr auto fields(const GraspDef*)
{
    using T = GraspDef;
    return describe("GraspDef",
                    field("stiffness", &T::stiffness, "N/m", positiveOrInfinite(), "of each contact's spring"),
                    field("breakForce", &T::breakForce, "N", positiveOrInfinite(),
                          "the sum of its contacts' forces beyond which it lets go"));
}

} // namespace filasofia::physics
