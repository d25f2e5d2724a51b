#include "filasofia/geometry/raw_tet_mesh.h"

#include "filasofia/core/log.h"
#include "filasofia/geometry/element_fault.h"

#include <algorithm>
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

TetMesh resolve(const RawTetMesh& raw, const NumberSource& nodeFile, const NumberSource& elementFile,
                std::string_view name)
{
    if (raw.elements.empty()) fail(name, ": must have at least 1 tetrahedron, got 0");
    const std::vector<int> order = orderByNumber(raw, nodeFile);
    const auto numberOf = [&](int i) { return raw.nodes[i].number; };
    TetMesh mesh;
    mesh.nodes.reserve(raw.nodes.size());
    for (const RawTetMesh::Node& node : raw.nodes) mesh.nodes.push_back(node.position);
    mesh.tetrahedra.reserve(raw.elements.size());
    for (const RawTetMesh::Element& element : raw.elements) {
        Tetrahedron& t = mesh.tetrahedra.emplace_back();
        for (int i = 0; i < 4; ++i) {
            const auto found = std::ranges::lower_bound(order, element.nodes[i], {}, numberOf);
            if (found == order.end() || numberOf(*found) != element.nodes[i])
                elementFile.failAt(element.place, "tetrahedron ", element.number, " names node ", element.nodes[i],
                                   ", which the file does not define; ", raw.nodes.size(), " nodes are defined, from ",
                                   order.empty() ? 0 : numberOf(order.front()), " to ",
                                   order.empty() ? 0 : numberOf(order.back()));
            t[i] = *found;
            if (std::find(t.begin(), t.begin() + i, t[i]) != t.begin() + i)
                elementFile.failAt(element.place, "tetrahedron ", element.number, " names node ", element.nodes[i],
                                   " twice; its four nodes must differ");
        }
        if (const std::string fault = elementFault(mesh, t); !fault.empty())
            elementFile.failAt(element.place, "tetrahedron ", element.number, fault);
    }
    if (raw.labelled) {
        for (const RawTetMesh::Element& element : raw.elements) mesh.labels.push_back(element.label);
        mesh.labelNames = raw.labelNames;
    }
    if (const auto pair = sameSidePair(mesh)) {
        const RawTetMesh::Element &a = raw.elements[(*pair)[0]], &b = raw.elements[(*pair)[1]];
        elementFile.failAt(b.place, "tetrahedra ", a.number, " and ", b.number,
                           " lie on the same side of their common face; they must lie on opposite sides");
    }
    return dropUnusedNodes(std::move(mesh), name);
}

} // namespace filasofia::geometry
