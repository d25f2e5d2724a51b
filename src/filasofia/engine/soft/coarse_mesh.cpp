#include "filasofia/engine/soft/coarse_mesh.h"

#include "filasofia/engine/soft/node_clusters.h"
#include "filasofia/geometry/dependent_nodes.h"
#include "filasofia/linalg/small_pieces.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace filasofia::engine {
namespace {

/// Per small piece: 1 if no pinned node and no pin spring holds it.
std::vector<char> freePieces(const CoarseMesh& mesh, const std::vector<std::vector<int>>& pieces)
{
    std::vector<int> pieceOf(mesh.rest.size(), -1);
    for (std::size_t p = 0; p < pieces.size(); ++p)
        for (int node : pieces[p]) pieceOf[static_cast<std::size_t>(node)] = static_cast<int>(p);
    std::vector<char> isFree(pieces.size(), 1);
    const auto hold = [&](int node) {
        if (const int piece = pieceOf[static_cast<std::size_t>(node)]; piece >= 0)
            isFree[static_cast<std::size_t>(piece)] = 0;
    };
    for (const auto& [a, b] : mesh.edges) {
        if (mesh.held[static_cast<std::size_t>(a)]) hold(b);
        if (mesh.held[static_cast<std::size_t>(b)]) hold(a);
    }
    for (const PinSpring& pin : mesh.pins) hold(pin.node);
    return isFree;
}

void refineLightNodes(const CoarseMesh& mesh, int most, geometry::CoarseLattice& lattice)
{
    constexpr double kLight = 0.2; // [-] relative to the median mass
    std::vector<std::pair<double, int>> light;
    for (int node : mesh.nodes) light.emplace_back(mesh.masses[static_cast<std::size_t>(node)], node);
    std::ranges::sort(light);
    const double least = kLight * light[light.size() / 2].first;
    std::vector<bool> inPiece(mesh.rest.size());
    for (const std::vector<int>& piece : lattice.pieces)
        for (int node : piece) inPiece[static_cast<std::size_t>(node)] = true;
    for (const auto& [mass, node] : light) {
        if (mass >= least || lattice.nodeCount >= most) return;
        if (inPiece[static_cast<std::size_t>(node)]) continue;
        lattice.corners[static_cast<std::size_t>(node)].fill(lattice.nodeCount++);
        lattice.weights[static_cast<std::size_t>(node)] = {1.0f, 0.0f, 0.0f, 0.0f};
    }
}

/// Removes coarse nodes from which no node interpolates any more.
void dropUnused(geometry::CoarseLattice& lattice)
{
    std::vector<int> number(static_cast<std::size_t>(lattice.nodeCount), -1);
    lattice.nodeCount = 0;
    for (std::size_t i = 0; i < lattice.corners.size(); ++i)
        for (std::size_t k = 0; k < 4; ++k)
            if (int& each = number[static_cast<std::size_t>(lattice.corners[i][k])];
                lattice.weights[i][k] != 0.0f && each < 0)
                each = lattice.nodeCount++;
    for (std::array<int, 4>& corners : lattice.corners)
        for (int& corner : corners) corner = std::max(0, number[static_cast<std::size_t>(corner)]);
}

/// Gives each node of a small piece a coarse node of its own.
void addPieceNodes(geometry::CoarseLattice& lattice)
{
    int first = linalg::firstPieceNode(lattice.nodeCount);
    for (const std::vector<int>& piece : lattice.pieces) {
        for (std::size_t i = 0; i < piece.size(); ++i) {
            lattice.corners[static_cast<std::size_t>(piece[i])].fill(first + static_cast<int>(i));
            lattice.weights[static_cast<std::size_t>(piece[i])] = {1.0f, 0.0f, 0.0f, 0.0f};
        }
        first += linalg::kPieceNodes;
    }
}

} // namespace

BuiltLattice buildLattice(const CoarseMesh& mesh, const CoarseChoice& choice)
{
    std::vector<bool> active(mesh.held);
    active.flip();
    geometry::CoarseLattice lattice = geometry::coarseLattice(mesh.rest, mesh.edges, active, choice.target);
    if (lattice.nodeCount > 0 && lattice.nodeCount < choice.most) {
        refineLightNodes(mesh, choice.most, lattice);
        geometry::dropDependent(lattice); // light nodes no longer use what their neighbours use alone now
        dropUnused(lattice);
    }
    addPieceNodes(lattice);
    std::vector<char> isFree = freePieces(mesh, lattice.pieces);
    return {std::move(lattice), std::move(isFree)};
}

bool hasShortEdges(const CoarseMesh& mesh)
{
    constexpr double kUneven = 4.0;
    struct Range {
        double shortest = std::numeric_limits<double>::infinity(), longest = 0.0;
    };
    std::vector<Range> ranges(mesh.rest.size());
    for (const auto& edge : mesh.edges) {
        const double length =
            distance(mesh.rest[static_cast<std::size_t>(edge[0])], mesh.rest[static_cast<std::size_t>(edge[1])]);
        for (int end : edge) {
            Range& at = ranges[static_cast<std::size_t>(end)];
            at = {std::min(at.shortest, length), std::max(at.longest, length)};
        }
    }
    const auto uneven = std::ranges::count_if(mesh.nodes, [&](int node) {
        const Range& at = ranges[static_cast<std::size_t>(node)];
        return at.longest > kUneven * at.shortest;
    });
    return uneven > 0 && 2 * static_cast<std::size_t>(uneven) >= mesh.nodes.size();
}

geometry::CoarseLattice clusterLattice(const CoarseMesh& mesh, const geometry::CoarseLattice& coarse)
{
    std::vector<bool> active(mesh.rest.size());
    for (int node : mesh.nodes) active[static_cast<std::size_t>(node)] = true;
    for (const std::vector<int>& piece : coarse.pieces)
        for (int node : piece) active[static_cast<std::size_t>(node)] = false; // solved exactly there
    geometry::CoarseLattice lattice;
    lattice.corners.resize(mesh.rest.size());
    lattice.weights.resize(mesh.rest.size());
    lattice.pieces = nodeClusters(mesh.rest, mesh.edges, active);
    addPieceNodes(lattice);
    return lattice;
}

} // namespace filasofia::engine
