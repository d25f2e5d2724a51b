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
                    field("visible", &T::visible, "whether it is visible from the start"));
}

} // namespace filasofia::runtime
