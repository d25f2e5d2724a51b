#include "filasofia/geometry/vtk_cells.h"

#include "filasofia/core/log.h"
#include "filasofia/core/word.h"

#include <algorithm>
#include <optional>
#include <set>

namespace filasofia::geometry {
namespace {

/// VTK's types of cells: points, lines and surfaces have no volume.
bool isFlat(std::int64_t type)
{
    return (type >= 1 && type <= 9) || (type >= 21 && type <= 23) || type == 28 || type == 30 || type == 34;
}

bool isSolid(std::int64_t type)
{
    return (type >= 10 && type <= 16) || (type >= 24 && type <= 27) || type == 29 || (type >= 31 && type <= 33) ||
           type == 37 || type == 42;
}

/// Surface cells of a fixed number of nodes, of which the corners come first.
struct FlatShape {
    std::int64_t type = 0;
    std::size_t nodes = 0, corners = 0;
};
constexpr FlatShape kFlatShapes[] = {{5, 3, 3},  {8, 4, 4},  {9, 4, 4},  {22, 6, 3},
                                     {23, 8, 4}, {28, 9, 4}, {30, 6, 4}, {34, 7, 3}};
constexpr std::int64_t kPolygon = 7, kPixel = 8, kSecondOrderLine = 21;

/// The solid of a type of cells, with its nodes in the order of Gmsh; none if it cannot be split.
std::optional<Solid> toSolid(std::int64_t type, std::vector<std::int64_t>& nodes, const RawTetMesh& mesh)
{
    const auto have = [&](std::size_t count) { return nodes.size() == count; };
    if ((type == 10 && have(4)) || (type == 24 && have(10))) return Solid::Simplex; // 24: second order
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

/// Meshes with fewer solids may well have a label for each.
constexpr std::size_t kFewSolids = 16;

/// Whether a list gives every solid a number of its own, as identifiers do.
bool numbersTheSolids(const VtkCells& cells, const std::vector<int>& list)
{
    std::set<int> seen;
    std::size_t solids = 0;
    for (std::size_t cell = 0; cell < cells.types.size(); ++cell) {
        if (isFlat(cells.types[cell])) continue;
        if (!seen.insert(list[cell]).second) return false;
        ++solids;
    }
    return solids >= kFewSolids;
}

std::string namesOf(const std::vector<const CellNumbers*>& lists)
{
    std::string all;
    for (const CellNumbers* each : lists) all += text(all.empty() ? "'" : ", '", shortened(each->name), "'");
    return all.empty() ? "none" : all;
}

const CellNumbers* labelsNamed(const VtkCells& cells, const std::string& asked, std::string_view file)
{
    const auto found = std::ranges::find(cells.numbers, asked, &CellNumbers::name);
    if (found != cells.numbers.end() && !found->whole.empty()) return &*found;
    std::vector<const CellNumbers*> whole;
    for (const CellNumbers& each : cells.numbers)
        if (!each.whole.empty()) whole.push_back(&each);
    fail(file, ": labels must name a list of whole numbers per cell, got '", shortened(asked), "', ",
         found == cells.numbers.end() ? "which the file does not have" : "whose numbers are no whole ones",
         "; its lists: ", namesOf(whole));
}

} // namespace

const CellNumbers* labelsAmong(const VtkCells& cells, const std::string& asked, std::string_view file)
{
    if (!asked.empty()) return labelsNamed(cells, asked, file);
    std::vector<const CellNumbers*> lists, numberings;
    for (const CellNumbers& each : cells.numbers)
        if (!each.whole.empty()) (numbersTheSolids(cells, each.whole) ? numberings : lists).push_back(&each);
    const std::string passed =
        numberings.empty() ? "" : text("; passed over, as each cell has its own number: ", namesOf(numberings));
    if (lists.empty() && !numberings.empty())
        logWarning(file, ": no labels: ", namesOf(numberings),
                   " gives each cell its own number; name it (labels) if "
                   "these are labels");
    if (lists.empty()) return nullptr;
    if (lists.size() + numberings.size() > 1)
        logInfo(file, ": labels are '", shortened(lists.front()->name), "'",
                lists.size() > 1 ? text(", the first of ", namesOf(lists), "; name another one with labels") : "",
                passed);
    return lists.front();
}

void checkOffsets(const VtkCells& cells, const NumberSource& file, std::size_t place)
{
    const std::vector<std::int64_t>& offsets = cells.offsets;
    const auto end = static_cast<std::int64_t>(cells.connectivity.size());
    if (offsets.empty() || offsets.front() != 0 || !std::ranges::is_sorted(offsets) || offsets.back() != end)
        file.failAt(place, "the offsets of cells must ascend from 0 to the number of their nodes, ", end);
}

void addCells(const VtkCells& cells, const CellNumbers* labels, const NumberSource& file, RawTetMesh& mesh)
{
    mesh.labelled = labels != nullptr;
    std::vector<std::int64_t> nodes;
    for (std::size_t cell = 0; cell < cells.types.size(); ++cell) {
        if (isFlat(cells.types[cell])) continue;
        nodes.assign(cells.connectivity.begin() + cells.offsets[cell],
                     cells.connectivity.begin() + cells.offsets[cell + 1]);
        const std::optional<Solid> solid = toSolid(cells.types[cell], nodes, mesh);
        if (!solid)
            file.failAt(cells.places[cell], "cell ", cell,
                        " must be a tetrahedron of 4 or 10 nodes, or a hexahedron, voxel, wedge or pyramid of "
                        "8, 8, 6 or 5 nodes, got VTK's type ",
                        cells.types[cell], " with ", nodes.size(), " nodes");
        addSolid(nodes,
                 {.number = static_cast<std::int64_t>(cell),
                  .place = cells.places[cell],
                  .label = labels ? labels->whole[cell] : 0,
                  .partOf = *solid},
                 file, mesh);
    }
}

void addPolygons(const VtkCells& cells, const NumberSource& file, RawSurface& surface)
{
    std::vector<std::int64_t> nodes;
    for (std::size_t cell = 0; cell + 1 < cells.offsets.size(); ++cell) {
        nodes.assign(cells.connectivity.begin() + cells.offsets[cell],
                     cells.connectivity.begin() + cells.offsets[cell + 1]);
        const std::int64_t type = cells.types.empty() ? kPolygon : cells.types[cell];
        if ((type >= 1 && type <= 4) || type == kSecondOrderLine) continue;
        if (isSolid(type)) {
            ++surface.solids;
            continue;
        }
        const auto* shape = std::ranges::find(kFlatShapes, type, &FlatShape::type);
        if (type != kPolygon && (shape == std::end(kFlatShapes) || nodes.size() != shape->nodes))
            file.failAt(cells.places[cell], "cell ", cell,
                        " must be a triangle, quad, pixel or polygon (type 5, 9, 8 or 7), got VTK's type ", type,
                        " with ", nodes.size(), " nodes");
        if (type == kPixel) std::swap(nodes[2], nodes[3]); // it counts in x, then y
        if (type != kPolygon && shape->corners < shape->nodes) {
            nodes.resize(shape->corners);
            ++surface.secondOrder;
        }
        surface.add(nodes, static_cast<std::int64_t>(cell), cells.places[cell]);
    }
}

} // namespace filasofia::geometry
