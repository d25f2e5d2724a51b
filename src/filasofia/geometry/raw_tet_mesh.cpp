#include "filasofia/geometry/raw_tet_mesh.h"

#include "filasofia/core/log.h"
#include "filasofia/geometry/element_fault.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace filasofia::geometry {
namespace {

// Node numbers in a file may have gaps of any width: this order allows a binary search by number.
std::vector<int> orderByNumber(const RawTetMesh& raw, const NumberSource& nodeFile)
{
    std::vector<int> order(raw.nodes.size());
    std::iota(order.begin(), order.end(), 0);
    const auto number = [&](int i) { return raw.nodes[i].number; };
    if (!std::ranges::is_sorted(order, {}, number)) std::ranges::stable_sort(order, {}, number);
    for (std::size_t i = 1; i < order.size(); ++i)
        if (number(order[i - 1]) == number(order[i]))
            nodeFile.failAt(raw.nodes[order[i]].place, "node ", number(order[i]), " is defined twice");
    return order;
}

/// How errors name a tetrahedron.
std::string solidName(const RawTetMesh::Element& element)
{
    const bool whole = element.partOf == Solid::Simplex;
    return text(whole ? "" : "a tetrahedron of ", nameOf(element.partOf), " ", element.number);
}

TetMesh dropUnusedNodes(TetMesh mesh, std::string_view name)
{
    std::vector<int> renumbered(mesh.nodes.size(), -1);
    for (const Tetrahedron& t : mesh.tetrahedra)
        for (int node : t) renumbered[node] = 0;
    int kept = 0;
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
        if (renumbered[i] < 0) continue;
        mesh.nodes[kept] = mesh.nodes[i];
        renumbered[i] = kept++;
    }
    const std::size_t dropped = mesh.nodes.size() - static_cast<std::size_t>(kept);
    if (dropped > 0) logInfo(name, ": ", dropped, " nodes that no tetrahedron uses were dropped");
    mesh.nodes.resize(kept);
    for (Tetrahedron& t : mesh.tetrahedra)
        for (int& node : t) node = renumbered[node];
    return mesh;
}

} // namespace

std::optional<int> labelOf(double value)
{
    if (value != std::floor(value) || !(std::abs(value) <= std::numeric_limits<int>::max())) return {};
    return static_cast<int>(value);
}

std::string_view nameOf(Solid solid)
{
    constexpr std::string_view kNames[] = {"tetrahedron", "hexahedron", "prism", "pyramid"};
    return kNames[static_cast<std::size_t>(solid)];
}

void addSolid(std::span<const std::int64_t> nodes, const RawTetMesh::Element& about, const NumberSource& file,
              RawTetMesh& mesh)
{
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (std::ranges::find(nodes.first(i), nodes[i]) != nodes.first(i).end())
            file.failAt(about.place, nameOf(about.partOf), " ", about.number, " names node ", nodes[i],
                        " twice; its nodes must differ");
    splitSolid(about.partOf, nodes,
               [&](const std::array<std::int64_t, 4>& part) { mesh.elements.emplace_back(about).nodes = part; });
    mesh.split += about.partOf != Solid::Simplex ? 1 : 0;
}

TetMesh resolve(const RawTetMesh& raw, const NumberSource& nodeFile, const NumberSource& elementFile,
                std::string_view name)
{
    if (raw.split > 0) logInfo(name, ": ", raw.split, " hexahedra, prisms and pyramids were split into tetrahedra");
    if (raw.elements.empty()) fail(name, ": must have at least 1 tetrahedron, got 0");
    const std::vector<int> order = orderByNumber(raw, nodeFile);
    const auto numberOf = [&](int i) { return raw.nodes[i].number; };
    TetMesh mesh;
    mesh.nodes.reserve(raw.nodes.size());
    for (const RawTetMesh::Node& node : raw.nodes) mesh.nodes.push_back(node.position);
    mesh.tetrahedra.reserve(raw.elements.size());
    std::size_t faulty = raw.elements.size(); // the first one
    for (const RawTetMesh::Element& element : raw.elements) {
        Tetrahedron& t = mesh.tetrahedra.emplace_back();
        for (int i = 0; i < 4; ++i) {
            const auto found = std::ranges::lower_bound(order, element.nodes[i], {}, numberOf);
            if (found == order.end() || numberOf(*found) != element.nodes[i])
                elementFile.failAt(element.place, nameOf(element.partOf), " ", element.number, " names node ",
                                   element.nodes[i], ", which the file does not define; ", raw.nodes.size(),
                                   " nodes are defined, from ", order.empty() ? 0 : numberOf(order.front()), " to ",
                                   order.empty() ? 0 : numberOf(order.back()));
            t[i] = *found;
        }
        if (faulty == raw.elements.size() && !elementFault(mesh, t).empty()) faulty = mesh.tetrahedra.size() - 1;
    }
    if (faulty < raw.elements.size())
        elementFile.failAt(raw.elements[faulty].place, solidName(raw.elements[faulty]),
                           elementFault(mesh, mesh.tetrahedra[faulty]), furtherFaults(mesh, faulty + 1));
    if (raw.labelled) {
        for (const RawTetMesh::Element& element : raw.elements) mesh.labels.push_back(element.label);
        mesh.labelNames = raw.labelNames;
    }
    if (const auto pair = sameSidePair(mesh)) {
        const RawTetMesh::Element &a = raw.elements[(*pair)[0]], &b = raw.elements[(*pair)[1]];
        const bool whole = a.partOf == Solid::Simplex && b.partOf == Solid::Simplex;
        elementFile.failAt(b.place, whole ? "tetrahedra " : "elements ", a.number, " and ", b.number,
                           " lie on the same side of their common face; they must lie on opposite sides");
    }
    return dropUnusedNodes(std::move(mesh), name);
}

} // namespace filasofia::geometry
