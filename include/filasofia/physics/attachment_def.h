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
    Vec3 centre = {};     ///< [m]
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
    std::vector<int> nodes = {};           ///< indices of the mesh
    std::optional<geometry::Box> box = {}; ///< and every node that is in this box now (world coordinates)
    std::optional<Ball> ball = {};         ///< and every node that is in this ball now (world coordinates)
    std::optional<double> within = {}; ///< [m], >= 0, and every node nearer than this to the surface of `to`, or inside
    double stiffness = kHard;          ///< [N/m], in (0, inf], of each node's spring; infinite: the node cannot leave
    BodyId to = {};                    ///< the body that holds them; none: they are held in space
    int element = 0;                   ///< [-], >= 0, of `to` where that is rigid
    AttachMode mode = AttachMode::Barycentric; ///< where `to` is soft
    double breakForce = kNever;                ///< [N], in (0, inf]: beyond this sum of its nodes' forces it lets go
};

/// Holds a rigid element: where it is in space, or on another body.
struct RigidAttachmentDef {
    int element = 0;               ///< [-], >= 0, of this body
    std::vector<Vec3> points = {}; ///< [m], in the element's coordinates, each held; none: place and orientation are
    double stiffness = kHard;      ///< [N/m], in (0, inf], of each point's spring
    BodyId to = {};                ///< the body that holds it; none: it is held in space
    int toElement = 0;             ///< [-], >= 0, of `to` where that is rigid
    double breakForce = kNever;    ///< [N], in (0, inf]: beyond this sum of its points' forces it lets go
};

/// Ties what a rigid body touches of another to it, as if they were glued where they touch: a grip that cannot slip.
struct GraspDef {
    double stiffness = kHard;   ///< [N/m], in (0, inf], of each contact's spring
    double breakForce = kNever; ///< [N], in (0, inf]: beyond this sum of its contacts' forces it lets go
};

constexpr auto fields(const Ball*)
{
    return describe("Ball", field("centre", &Ball::centre, "m", finite(), "its middle"),
                    field("radius", &Ball::radius, "m", positive(), "from there to its surface"));
}
constexpr auto fields(const AttachmentDef*)
{
    using T = AttachmentDef;
    return describe("AttachmentDef", field("nodes", &T::nodes, "-", nonNegative(), "indices of the nodes held"),
                    field("box", &T::box, "and the nodes in this box"),
                    field("ball", &T::ball, "and the nodes in this ball"),
                    field("within", &T::within, "m", nonNegative(), "and the nodes so near to the other body"),
                    field("stiffness", &T::stiffness, "N/m", positiveOrInfinite(), "of each node's spring"),
                    field("to", &T::to, "the body that holds them"),
                    field("element", &T::element, "-", nonNegative(), "of a rigid one"),
                    field("mode", &T::mode, "what of a soft one"),
                    field("breakForce", &T::breakForce, "N", positiveOrInfinite(), "beyond it, it lets go"));
}
constexpr auto fields(const RigidAttachmentDef*)
{
    using T = RigidAttachmentDef;
    return describe("RigidAttachmentDef", field("element", &T::element, "-", nonNegative(), "of this body"),
                    field("points", &T::points, "m", finite(), "each held"),
                    field("stiffness", &T::stiffness, "N/m", positiveOrInfinite(), "of each point's spring"),
                    field("to", &T::to, "the body that holds it"),
                    field("toElement", &T::toElement, "-", nonNegative(), "of a rigid one"),
                    field("breakForce", &T::breakForce, "N", positiveOrInfinite(), "beyond it, it lets go"));
}
constexpr auto fields(const GraspDef*)
{
    using T = GraspDef;
    return describe("GraspDef", field("stiffness", &T::stiffness, "N/m", positiveOrInfinite(), "of each contact"),
                    field("breakForce", &T::breakForce, "N", positiveOrInfinite(), "beyond it, it lets go"));
}

} // namespace filasofia::physics
