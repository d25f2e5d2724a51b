#include "filasofia/geometry/split_solid.h"

#include <algorithm>

namespace filasofia::geometry {
namespace {

using SolidFace = std::array<int, 4>; // counterclockwise from outside; -1 behind a triangle
constexpr SolidFace kHexahedron[] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                     {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
constexpr SolidFace kPrism[] = {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
constexpr SolidFace kPyramid[] = {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}};

std::span<const SolidFace> facesOf(Solid kind)
{
    if (kind == Solid::Hexahedron) return kHexahedron;
    if (kind == Solid::Prism) return kPrism;
    return kPyramid;
}

} // namespace

void splitSolid(Solid kind, std::span<const std::int64_t> nodes,
                const std::function<void(const std::array<std::int64_t, 4>&)>& add)
{
    if (kind == Solid::Simplex) {
        add({nodes[0], nodes[1], nodes[2], nodes[3]});
        return;
    }
    // The node of the lowest number is a corner of every tetrahedron. The faces that it lies on are thereby cut along
    // the diagonals through it.
    const std::int64_t apex = std::ranges::min(nodes);
    for (const SolidFace& face : facesOf(kind)) {
        std::array<std::int64_t, 4> at{};
        const std::size_t count = face[3] < 0 ? 3 : 4;
        for (std::size_t k = 0; k < count; ++k) at[k] = nodes[static_cast<std::size_t>(face[k])];
        const auto end = at.begin() + static_cast<std::ptrdiff_t>(count);
        if (std::find(at.begin(), end, apex) != end) continue;
        std::rotate(at.begin(), std::min_element(at.begin(), end), end);
        for (std::size_t k = 2; k < count; ++k) add({at[0], at[k], at[k - 1], apex});
    }
}

} // namespace filasofia::geometry
