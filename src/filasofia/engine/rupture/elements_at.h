#pragma once

#include "filasofia/geometry/tet_mesh.h"

#include <functional>
#include <span>
#include <vector>

namespace filasofia::engine {

/// The elements of a body: their nodes, and those that are left out, in which nothing moves.
struct ElementsToTest {
    std::size_t count = 0;
    std::function<geometry::Tetrahedron(std::size_t)> nodes; ///< as frame/topology_edit.h writes them
    std::function<bool(std::size_t)> isLeftOut;
};

/// [-] How many elements the triangles of a blade are in, or touch from within a cut. `corners` [m]: those of the
/// triangles, three by three. `places` [m]: per node of the body.
int elementsAt(const std::vector<Vec3>& corners, const ElementsToTest& elements, const std::vector<Vec3>& places);

/// Whether two convex bodies are nearer to each other than `margin` [m], up to corners, which count as round: a
/// triangle, and an element of three or four corners.
bool isNear(std::span<const Vec3> triangle, std::span<const Vec3> element, double margin);

/// [-] Tissue moves around a blade that is switched off, and so do the elements that it is in. Whether there are so
/// many more `now` than `then` that the blade was pushed on.
bool isPushedOn(int now, int then);

} // namespace filasofia::engine
