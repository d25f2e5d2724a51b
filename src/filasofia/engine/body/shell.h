#pragma once

#include "filasofia/engine/elastic/bending.h"
#include "filasofia/engine/elastic/membrane.h"
#include "filasofia/geometry/triangle_mesh.h"
#include "filasofia/physics/shell_material.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// What a soft body of triangles consists of; empty for all others.
struct Shell {
    physics::ShellMaterial material = {};
    std::vector<MembraneElement> membranes = {}; ///< neighbours are near each other in the list
    std::vector<BendingElement> bends = {};      ///< one per triangle, in the same order; none in a membrane
};

/// The triangles of a shell with these nodes at rest. The mesh must pass physics::checkShell().
Shell makeShell(const physics::ShellMaterial& material, const std::vector<Vec3>& rest,
                const std::vector<geometry::Triangle>& triangles);

/// The same triangles in the same order, of another material.
Shell makeShell(const physics::ShellMaterial& material, const std::vector<Vec3>& rest, const Shell& like);

/// Shapes one triangle again after an edit: `nodes` are its own, `across` the nodes opposite its edges in its
/// neighbours (-1: none), where edge i lies opposite corner i. Appends it if it is the next; it is then of the same
/// triangle of the Def's mesh as `parent`.
struct TriangleEdit {
    std::size_t triangle = 0, parent = 0;
    std::array<int, 3> nodes{}, across{-1, -1, -1};
};
void shapeTriangle(const TriangleEdit& edit, const std::vector<Vec3>& rest, Shell& shell);

/// Every edge of a shell once, lower node first, ascending.
std::vector<std::array<int, 2>> edgesOf(const Shell& shell);

/// The vectors at the nodes of a triangle, or of a triangle and its neighbours.
template <std::size_t n> std::array<Vec3, n> vectorsAt(const std::array<int, n>& nodes, std::span<const Vec3> all)
{
    std::array<Vec3, n> out;
    for (std::size_t i = 0; i < n; ++i) out[i] = all[static_cast<std::size_t>(nodes[i])];
    return out;
}

/// Throws an Error that begins with `object` if a number or an index is invalid; the shell has so many nodes.
void check(const Shell& shell, std::size_t nodes, const std::string& object);

/// [-] By how much a principal stretch of a triangle differs from 1 at most.
double strainOf(const MembraneElement& element, std::span<const Vec3> x);

} // namespace filasofia::engine
