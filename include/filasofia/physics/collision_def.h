#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <memory>
#include <string>
#include <variant>

namespace filasofia::physics {

/// A triangle mesh: the name of a file, or the mesh itself; an empty name: none given.
using TriangleMeshSource = std::variant<std::string, std::shared_ptr<const geometry::TriangleMesh>>;

/// Which features of a collision mesh touch others. Points meet triangles, lines meet lines; where a mesh has no
/// triangles its lines meet points as well, and where it has neither its points do.
struct Primitives {
    bool points = true;
    bool lines = true;
    bool triangles = true;
};

/// One way in which a body is touched.
struct CollisionDef {
    TriangleMeshSource mesh = {}; ///< none given: the body's own surface. A soft body's is in the coordinates of its
                                  ///< tetrahedra and rides on them; a rigid one's in those of its element
    int element = 0;              ///< [-], >= 0, of a rigid body's elements; 0 for a soft body
    Primitives primitives = {};
    double proximity = 0.5e-3; ///< [m], >= 0; contacts are found where surfaces are nearer than the sum of both bodies'
    int group = 0;             ///< only models of the same group touch each other
    bool self = false;         ///< does it touch itself where the body folds
    /// On a rigid body: a blade. Its lines (the mesh's edges, or those of its segments) cut soft bodies with
    /// dynamicTopology of its group and pass through them; all else of the group it pushes. On a soft body: the groups
    /// whose blades may cut it, where that is not all that its other models are in; nothing touches such a model.
    bool cutting = false;
};

/// Nothing goes through anything, friction after Coulomb, forces as they follow from that: contact forces are found
/// together with the motion (augmented Lagrangian; Alart and Curnier 1991).
struct ExactContact {
    int rounds = 8; ///< [-], in [1, 100], of forty iterations in which a step finds out what touches and what slides
    double tolerance = 5e-3; ///< [-], in (0, 1), of forces, relative to all of them
};
/// Surfaces are pushed apart in proportion to how far they are inside each other: soft, and cheap. A force F on n
/// contacts sinks in by F / (n stiffness), and what is deeper than both proximities and insets (1.2 mm by default) is
/// lost and falls through: with the default stiffness some 0.4 kg on four corners are the most.
struct PenaltyContact {
    double stiffness = 1000.0; ///< [N/m], > 0, of each contact
    double damping = 0.0;      ///< [N s/m], >= 0, of each contact inside, against the motion along the normal
};
using ContactMethod = std::variant<ExactContact, PenaltyContact>;

constexpr auto fields(const Primitives*)
{
    using T = Primitives;
    return describe("Primitives", field("points", &T::points, "its vertices"), field("lines", &T::lines, "its edges"),
                    field("triangles", &T::triangles, "its triangles"));
}
constexpr auto fields(const CollisionDef*)
{
    using T = CollisionDef;
    return describe("CollisionDef", field("mesh", &T::mesh, "a surface's file, or the surface"),
                    field("element", &T::element, "-", nonNegative(), "of a rigid body's elements"),
                    field("primitives", &T::primitives, "which features touch"),
                    field("proximity", &T::proximity, "m", nonNegative(), "both bodies' add up"),
                    field("group", &T::group, "only models of one group touch"),
                    field("self", &T::self, "does it touch itself"), field("cutting", &T::cutting, "registers cuts"));
}
constexpr auto fields(const ExactContact*)
{
    using T = ExactContact;
    return describe("ExactContact", field("rounds", &T::rounds, "-", closed(1, 100), "per step, at most"),
                    field("tolerance", &T::tolerance, "-", open(0, 1), "of forces, relative to all of them"));
}
constexpr auto fields(const PenaltyContact*)
{
    using T = PenaltyContact;
    return describe("PenaltyContact", field("stiffness", &T::stiffness, "N/m", positive(), "of each contact"),
                    field("damping", &T::damping, "N s/m", nonNegative(), "of each contact, along the normal"));
}

} // namespace filasofia::physics
