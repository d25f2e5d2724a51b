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

// Warns of the nodes in the middle of edges that no element has for a corner. The order of the edges differs between
// formats, so such a node is compared with the middle of the edge that is nearest.
void warnOfMiddles(const RawTetMesh& raw, const TetMesh& mesh, const std::vector<int>& middles, std::string_view name)
{
    constexpr double kStraight = 1e-3; // relative to the edge; less is rounding
    std::vector<bool> left(mesh.nodes.size()), bent(mesh.nodes.size());
    std::size_t solids = 0;
    double largest = 0.0;
    for (std::size_t i = 0; i < middles.size(); ++i) {
        const std::size_t element = raw.middles[i].element;
        if (i == 0 || raw.middles[i - 1].element != element) ++solids;
        const Tetrahedron& t = mesh.tetrahedra[element];
        double nearest = std::numeric_limits<double>::infinity(), edge = 0.0;
        for (const auto [a, b] : kTetrahedronEdges) {
            const double off = distance(mesh.nodes[middles[i]], 0.5 * (mesh.nodes[t[a]] + mesh.nodes[t[b]]));
            if (off < nearest) nearest = off, edge = distance(mesh.nodes[t[a]], mesh.nodes[t[b]]);
        }
        left[middles[i]] = true;
        if (!(nearest > kStraight * edge)) continue;
        bent[middles[i]] = true;
        largest = std::max(largest, nearest / edge);
    }
    const auto curved = std::ranges::count(bent, true);
    logWarning(name, ": ", solids,
               " tetrahedra of second order were read with their corners only: ", std::ranges::count(left, true),
               " nodes in the middle of edges were left out",
               curved == 0
                   ? ""
                   : text("; ", curved, " of them bend their edge, by up to ", std::round(1000.0 * largest) / 10.0,
                          " % of its length: the mesh is straight there now"));
}

/// Drops unused nodes and tells, unless they are those in the middle of edges.
void dropUnused(const std::vector<int>& middles, std::string_view name, TetMesh& mesh)
{
    std::vector<bool> explained(mesh.nodes.size());
    for (const int node : middles) explained[static_cast<std::size_t>(node)] = true;
    for (const Tetrahedron& t : mesh.tetrahedra)
        for (const int node : t) explained[static_cast<std::size_t>(node)] = false;
    const auto left = static_cast<std::size_t>(std::ranges::count(explained, true));
    if (const std::size_t dropped = dropUnusedNodes(mesh) - left; dropped > 0)
        logInfo(name, ": ", dropped, " nodes that no tetrahedron uses were dropped");
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
    if (about.partOf == Solid::Simplex)
        for (const std::int64_t node : nodes.subspan(4)) mesh.middles.push_back({node, mesh.elements.size()});
    splitSolid(about.partOf, nodes,
               [&](const std::array<std::int64_t, 4>& part) { mesh.elements.emplace_back(about).nodes = part; });
    mesh.split += about.partOf != Solid::Simplex ? 1 : 0;
}

void checkNumbers(const RawTetMesh& mesh, const NumberSource& nodeFile)
{
    static_cast<void>(orderByNumber(mesh, nodeFile));
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
    const auto find = [&](const RawTetMesh::Element& element, std::int64_t node) {
        const auto found = std::ranges::lower_bound(order, node, {}, numberOf);
        if (found == order.end() || numberOf(*found) != node)
            elementFile.failAt(element.place, nameOf(element.partOf), " ", element.number, " names node ", node,
                               ", which the file does not define; ", raw.nodes.size(), " nodes are defined, from ",
                               order.empty() ? 0 : numberOf(order.front()), " to ",
                               order.empty() ? 0 : numberOf(order.back()));
        return *found;
    };
    for (const RawTetMesh::Element& element : raw.elements) {
        Tetrahedron& t = mesh.tetrahedra.emplace_back();
        for (int i = 0; i < 4; ++i) t[i] = find(element, element.nodes[i]);
        if (faulty == raw.elements.size() && !elementFault(mesh, t).empty()) faulty = mesh.tetrahedra.size() - 1;
    }
    std::vector<int> middles;
    for (const RawTetMesh::Middle& each : raw.middles) middles.push_back(find(raw.elements[each.element], each.node));
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
    if (!middles.empty()) warnOfMiddles(raw, mesh, middles, name);
    dropUnused(middles, name, mesh);
    return mesh;
}

} // namespace filasofia::geometry
