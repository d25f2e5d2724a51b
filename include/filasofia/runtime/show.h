#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/visual/material.h"

#include <compare>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>

namespace filasofia::runtime {

/// A surface: the name of a file, or the surface itself.
using SurfaceSource = std::variant<std::string, std::shared_ptr<const geometry::TriangleMesh>>;

/// Names what one call of show() draws. Numbers are given once and never used again; 0 names nothing.
struct ShownId {
    std::uint32_t value = 0;

    constexpr explicit operator bool() const { return value != 0; }
    friend constexpr auto operator<=>(ShownId, ShownId) = default;
};

/// Connective tissue: each point of an attachment between two bodies is drawn as strands from one to the other, as long
/// as it holds.
struct StrandsDef {
    int attachment = 0;     ///< [-], >= 0, index among the attachments of the body's Def; it has points that let go
                            ///< one by one (pointBreakForce or cutDistance)
    double radius = 0.1e-3; ///< [m], > 0, in the middle of a strand; at its ends it is 1.8 times as thick
    int perPoint = 3;       ///< [-], in [1, 20], strands of each point
    double spread = 1.0e-3; ///< [m], >= 0, how far from the point they begin and end

    friend bool operator==(const StrandsDef&, const StrandsDef&) = default;
};
constexpr auto fields(const StrandsDef*)
{
    using T = StrandsDef;
    return describe("StrandsDef",
                    field("attachment", &T::attachment, "-", nonNegative(), "index among the body's attachments"),
                    field("radius", &T::radius, "m", positive(), "of a strand, in its middle"),
                    field("perPoint", &T::perPoint, "-", closed(1, 20), "strands of each point"),
                    field("spread", &T::spread, "m", nonNegative(), "how far from the point they begin and end"));
}

/// How a body is drawn. Body and surface decide how the surface follows the body: rigidly with an element, node by
/// node, or embedded in the tetrahedra of a soft body.
struct ShowDef {
    SurfaceSource surface = {}; ///< in the body's coordinates; empty: a soft body's boundary (a shell's triangles),
                                ///< or a rigid one's mesh at every element
    int element = 0;            ///< [-], >= 0, the element of a rigid body that carries a given surface
    int subdivision = 0;        ///< [-], in [0, 3], each level has four times the triangles
    /// What it looks like. Not given: as what the body is: tissue if it is soft, grey plastic if it is rigid, a
    /// thread's violet if it is a rod.
    std::optional<visual::Material> material = {};
    /// What the inside looks like if cuts and tears open a soft body that is drawn as its own boundary. Not given: the
    /// material above, redder and wetter if it is tissue.
    std::optional<visual::Material> interior = {};
    bool castShadows = true;
    bool visible = true; ///< false: it exists, and Simulation::setVisible() shows it
    /// Given: the strands of an attachment of a soft body are drawn, and not the body; `surface` is empty then.
    std::optional<StrandsDef> strands = {};
};
constexpr auto fields(const ShowDef*)
{
    using T = ShowDef;
    return describe("ShowDef", field("surface", &T::surface, "a surface file, or the surface"),
                    field("element", &T::element, "-", nonNegative(), "element of a rigid body"),
                    field("subdivision", &T::subdivision, "-", closed(0, 3), "each level has four times the triangles"),
                    field("material", &T::material, "what it looks like; not given: as what the body is"),
                    field("interior", &T::interior, "what it looks like where it is cut"),
                    field("castShadows", &T::castShadows, "whether it casts shadows"),
                    field("visible", &T::visible, "whether it is visible from the start"),
                    field("strands", &T::strands, "draws the strands of an attachment in place of the body"));
}
constexpr std::size_t addedFields(const ShowDef*) { return 1; }

} // namespace filasofia::runtime
