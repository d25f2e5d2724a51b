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

/// [-] How many elements a blade is in.
struct ElementsAtBlade {
    int near = 0; ///< or touches from within a cut
    int inside = 0;

    ElementsAtBlade& operator+=(const ElementsAtBlade& other)
    {
        near += other.near;
        inside += other.inside;
        return *this;
    }
};

/// `corners` [m]: those of the blade's triangles, three by three. `places` [m]: per node of the body.
ElementsAtBlade elementsAt(const std::vector<Vec3>& corners, const ElementsToTest& elements,
                           const std::vector<Vec3>& places);

/// Whether two convex bodies are nearer to each other than `margin` [m], up to corners, which count as round: a
/// triangle, and an element of three or four corners. A negative margin: whether they overlap by more than its size.
bool isNear(std::span<const Vec3> triangle, std::span<const Vec3> element, double margin);

/// A *sheath* [-]: 0 for a blade that is off and out of all tissue. Otherwise one more than the elements that it was
/// inside of when it was switched off. The walls of its cut are not among them: they lie on it, or part from it where
/// they collide with each other.
inline int sheathOf(const ElementsAtBlade& at) { return at.near == 0 ? 0 : 1 + at.inside; }

/// Whether a blade with this sheath is inside so many more elements now that it was pushed on into tissue, or the
/// tissue was moved through it.
bool isPushedOn(const ElementsAtBlade& now, int sheath);

} // namespace filasofia::engine
