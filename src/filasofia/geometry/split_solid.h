#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

namespace filasofia::geometry {

/// Solids of mesh files that are split into tetrahedra (a simplex is one), with their nodes in the order of Gmsh and
/// VTK.
enum class Solid { Simplex, Hexahedron, Prism, Pyramid };

/// Splits a convex solid, given by the numbers of its nodes, into tetrahedra of positive volume. Every quadrilateral
/// face is cut along the diagonal through its lowest number, so that two solids fit together at their common face
/// (Dompierre et al. 1999, "How to subdivide pyramids, prisms and hexahedra into tetrahedra"). Calls `add` with the
/// nodes of each.
void splitSolid(Solid kind, std::span<const std::int64_t> nodes,
                const std::function<void(const std::array<std::int64_t, 4>&)>& add);

} // namespace filasofia::geometry
