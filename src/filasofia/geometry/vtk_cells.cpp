#include "filasofia/geometry/vtk_cells.h"

#include <algorithm>
#include <optional>

namespace filasofia::geometry {
namespace {

/// VTK's types of cells: points, lines and surfaces have no volume.
bool isFlat(std::int64_t type)
{
    return (type >= 1 && type <= 9) || (type >= 21 && type <= 23) || type == 28 || type == 30 || type == 34;
}

/// The solid of a type of cells, with its nodes in the order of Gmsh; none if it cannot be split.
std::optional<Solid> toSolid(std::int64_t type, std::vector<std::int64_t>& nodes, const RawTetMesh& mesh)
{
    const auto have = [&](std::size_t count) { return nodes.size() == count; };
    if (type == 10 && have(4)) return Solid::Simplex;
    if (type == 12 && have(8)) return Solid::Hexahedron;
    if (type == 14 && have(5)) return Solid::Pyramid;
    if (type == 11 && have(8)) { // a voxel counts in x, then y, then z
        std::swap(nodes[2], nodes[3]);
        std::swap(nodes[6], nodes[7]);
        return Solid::Hexahedron;
    }
    if (type != 13 || !have(6)) return {};
    // VTK's first triangle of a wedge points outwards, but many programs write it as others do.
    const auto at = [&](std::size_t k) {
        const auto node = static_cast<std::uint64_t>(nodes[k]);
        return node < mesh.nodes.size() ? mesh.nodes[node].position : Vec3{};
    };
    if (signedVolume(at(0), at(1), at(2), at(3)) < 0.0) {
        std::swap(nodes[1], nodes[2]);
        std::swap(nodes[4], nodes[5]);
    }
    return Solid::Prism;
}

} // namespace

void checkOffsets(const VtkCells& cells, const NumberSource& file, std::size_t place)
{
    const std::vector<std::int64_t>& offsets = cells.offsets;
    const auto end = static_cast<std::int64_t>(cells.connectivity.size());
    if (offsets.empty() || offsets.front() != 0 || !std::ranges::is_sorted(offsets) || offsets.back() != end)
        file.failAt(place, "the offsets of cells must ascend from 0 to the number of their nodes, ", end);
}

void addCells(const VtkCells& cells, const NumberSource& file, RawTetMesh& mesh)
{
    mesh.labelled = !cells.labels.empty();
    std::vector<std::int64_t> nodes;
    for (std::size_t cell = 0; cell < cells.types.size(); ++cell) {
        if (isFlat(cells.types[cell])) continue;
        nodes.assign(cells.connectivity.begin() + cells.offsets[cell],
                     cells.connectivity.begin() + cells.offsets[cell + 1]);
        const std::optional<Solid> solid = toSolid(cells.types[cell], nodes, mesh);
        if (!solid)
            file.failAt(cells.places[cell], "cell ", cell,
                        " must be a tetrahedron, hexahedron, voxel, wedge or pyramid of 4, 8, "
                        "8, 6 or 5 nodes, got VTK's type ",
                        cells.types[cell], " with ", nodes.size(), " nodes");
        addSolid(nodes,
                 {.number = static_cast<std::int64_t>(cell),
                  .place = cells.places[cell],
                  .label = mesh.labelled ? cells.labels[cell] : 0,
                  .partOf = *solid},
                 file, mesh);
    }
}

} // namespace filasofia::geometry
