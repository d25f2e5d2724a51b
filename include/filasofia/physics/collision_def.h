#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <memory>
#include <optional>
#include <string>
#include <variant>

namespace filasofia::physics {

/// A triangle mesh: the name of a file, or the mesh itself. An empty name means that no mesh is given.
using TriangleMeshSource = std::variant<std::string, std::shared_ptr<const geometry::TriangleMesh>>;

/// The features of a collision mesh that collide with others. Points collide with triangles, and lines with lines. If a
/// mesh has no triangles, its lines also collide with points; if it has neither, its points collide with points.
struct Primitives {
    bool points = true;
    bool lines = true;
    bool triangles = true;
};

/// One collision model of a body.
struct CollisionDef {
    /// if none is given, the body's own surface. A soft body's collision mesh is in the coordinates of its tetrahedra
    /// and is embedded in them; a rigid body's is in those of its element
    TriangleMeshSource mesh = {};
    int element = 0; ///< [-], >= 0, element of a rigid body; 0 for a soft body
    Primitives primitives = {};
    double proximity =
        0.5e-3;    ///< [m], >= 0; contacts are found where surfaces are nearer than the sum of both bodies' proximities
    int group = 0; ///< only models of the same group collide
    /// Whether the body collides with itself: a soft body's model where it folds, and all models of one body and group
    /// that have it with each other. Models of one rigid element never meet, nor do those of two links with a joint
    /// between them, which overlap there.
    bool self = false;
    /// Whether the own surface of a solid soft body collides with itself once the body has been cut or torn, fragments
    /// of at most 32 elements apart: a flap then rests on its bed, and a severed piece on the rest, into which they
    /// sink otherwise. It costs what contacts cost. Not given: as the engine can; the native one does, SOFA cannot.
    std::optional<bool> selfOnceCut = {};
    /// On a rigid body, a blade: its lines (the mesh's edges, or those of its segments) cut soft bodies of its group
    /// that have dynamicTopology and pass through them; it pushes everything else of the group. On a soft body: the
    /// groups whose blades may cut it, if these are not all groups of its other models; nothing collides with such a
    /// model.
    bool cutting = false;
};

/// Contact without penetration and with Coulomb friction: contact forces are found together with the motion (augmented
/// Lagrangian; Alart and Curnier 1991).
struct ExactContact {
    int rounds = 8; ///< [-], in [1, 100], rounds of forty iterations in which a step determines which contacts are
                    ///< closed and which slide
    double tolerance = 5e-3; ///< [-], in (0, 1), error of the forces, relative to all of them
};
/// Contact by a penalty force: surfaces are pushed apart in proportion to their penetration. Compliant, and cheap. A
/// force F on n contacts penetrates by F / (n stiffness). If the penetration exceeds both proximities and insets (1.2
/// mm by default), the contact is lost and the body falls through: with the default stiffness, some 0.4 kg on four
/// corners are the maximum.
struct PenaltyContact {
    double stiffness = 1000.0; ///< [N/m], > 0, of each contact
    double damping = 0.0;      ///< [N s/m], >= 0, of each penetrating contact, against the motion along the normal
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
    return describe("CollisionDef", field("mesh", &T::mesh, "its surface, or the file of its surface"),
                    field("element", &T::element, "-", nonNegative(), "element of a rigid body"),
                    field("primitives", &T::primitives, "features that collide"),
                    field("proximity", &T::proximity, "m", nonNegative(),
                          "distance within which contacts are found; both bodies' proximities add up"),
                    field("group", &T::group, "only models of the same group collide"),
                    field("self", &T::self, "whether the body collides with itself"),
                    field("selfOnceCut", &T::selfOnceCut,
                          "whether it does once it has been cut or torn; not given: as the engine can"),
                    field("cutting", &T::cutting,
                          "rigid: whether it is a blade; soft: whether it only tells which blades may cut the body"));
}
constexpr auto fields(const ExactContact*)
{
    using T = ExactContact;
    return describe("ExactContact",
                    field("rounds", &T::rounds, "-", closed(1, 100), "largest number of rounds per step"),
                    field("tolerance", &T::tolerance, "-", open(0, 1), "error of the forces, relative to all of them"));
}
constexpr auto fields(const PenaltyContact*)
{
    using T = PenaltyContact;
    return describe("PenaltyContact", field("stiffness", &T::stiffness, "N/m", positive(), "stiffness of each contact"),
                    field("damping", &T::damping, "N s/m", nonNegative(), "damping of each contact along the normal"));
}

} // namespace filasofia::physics
