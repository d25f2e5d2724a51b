#include "filasofia/geometry/coarse_lattice.h"

#include "filasofia/core/assert.h"
#include "filasofia/geometry/lattice_graph.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace filasofia::geometry {
namespace {

constexpr double kMinSupport = 0.05;   // a coarse node with a smaller fraction of the median node's support is dropped
constexpr double kMinKeptWeight = 0.2; // dropping must leave a node at least this fraction of its weight
constexpr double kMinWeight = 1e-6;    // below it a corner counts as not used
constexpr double kMaxLatticeCoordinate = 1e100; // [m]

// A lattice point's three coordinates, or a cell (the coordinates of its lowest corner and the order of its steps), in
// one number. A piece spans less than 2^18 cells, so no coordinate overflows into the next. Different pieces may have
// equal keys.
using Key = std::uint64_t;
constexpr std::array<Key, 3> kUnit{Key(1), Key(1) << 20, Key(1) << 40};
constexpr Key kOwnCell = Key(1) << 63;
constexpr int kHalvings = 15; // from the largest cell to the smallest
constexpr int kOrders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};

struct Place {
    Key cell = 0;
    std::array<double, 4> weights{}; // weights of the cell's corners
};

std::array<Key, 4> cornersOf(Key cell)
{
    if (cell == kOwnCell) return {kOwnCell, kOwnCell + 1, kOwnCell + 2, kOwnCell + 3};
    std::array<Key, 4> corner{cell >> 3};
    for (int step = 0; step < 3; ++step) corner[step + 1] = corner[step] + kUnit[kOrders[cell & 7][step]];
    return corner;
}

// The tetrahedra of the body-centred cubic lattice, which are all congruent. In the basis (-1,1,1), (1,-1,1), (1,1,-1),
// each half a cube's edge, the lattice is that of the whole numbers and its tetrahedra are Kuhn's: one per order of the
// fractional parts (Adams, Baek, Davis 2010, "Fast high-dimensional filtering using the permutohedral lattice").
Place placeInLattice(Vec3 p, Vec3 origin, double cube)
{
    const Vec3 x = (p - origin) / cube;
    const std::array<double, 3> y{x.y + x.z, x.x + x.z, x.x + x.y};
    std::array<double, 3> part{};
    Key point = 0;
    for (int k = 0; k < 3; ++k) {
        part[k] = y[k] - std::floor(y[k]);
        point += static_cast<Key>(std::floor(y[k])) * kUnit[k];
    }
    int order = 0;
    const auto descends = [&](const int(&o)[3]) { return part[o[0]] >= part[o[1]] && part[o[1]] >= part[o[2]]; };
    while (!descends(kOrders[order])) ++order;
    const auto [a, b, c] = kOrders[order];
    return {(point << 3) + static_cast<Key>(order), {1.0 - part[a], part[a] - part[b], part[b] - part[c], part[c]}};
}

// Places a point in a single tetrahedron around a whole piece.
Place placeInBox(Vec3 p, const Box& box)
{
    Place place{kOwnCell, {1.0, 0.0, 0.0, 0.0}};
    for (int k = 0; k < 3; ++k) {
        const double side = box.high[k] - box.low[k];
        const double share = side > 0.0 ? (p[k] - box.low[k]) / side / 3.0 : 0.0;
        place.weights[k + 1] = share;
        place.weights[0] = std::max(0.0, place.weights[0] - share);
    }
    return place;
}

double longestSide(const Box& box)
{
    const Vec3 size = box.high - box.low;
    return std::max({size.x, size.y, size.z});
}

constexpr int kNone = -1;

struct LatticeLayout {
    std::vector<Place> places;               // per node
    std::vector<std::array<int, 4>> corners; // per node, its coarse nodes; kNone if the weight is 0
    int count = 0;
};

// The size and offset of the cells: cubes with an edge of `cube` [m], their lattice moved by `shift` cubes. If a
// piece's longest side times `fit` is at most `cube`, the piece gets a tetrahedron of its own.
struct Cells {
    double cube = 0.0;
    Vec3 shift;
    double fit = 1.0;
};

void placeNodes(const Graph& graph, const Cells& cells, LatticeLayout& out)
{
    out.places.reserve(graph.nodes.size());
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        const Box& box = graph.box[graph.piece[i]];
        const bool within = !(cells.fit * longestSide(box) > cells.cube);
        const Vec3 origin = box.low - cells.cube * cells.shift;
        out.places.push_back(within ? placeInBox(graph.nodes[i], box)
                                    : placeInLattice(graph.nodes[i], origin, cells.cube));
    }
}

// Cuts the body along the cells, then joins the parts again along the body's edges.
void connect(const Graph& graph, LatticeLayout& out)
{
    // Nodes of one cell that are connected inside it share one copy of the cell.
    const int n = static_cast<int>(graph.nodes.size());
    DisjointSets together(graph.nodes.size());
    for (auto [a, b] : graph.edges)
        if (out.places[a].cell == out.places[b].cell) together.join(a, b);
    std::vector<int> copy(graph.nodes.size());
    std::vector<std::array<Key, 4>> cornerKeys; // per copy
    for (int i = 0; i < n; ++i) {
        const int first = together.find(i);
        copy[i] = first == i ? static_cast<int>(cornerKeys.size()) : copy[first];
        if (first == i) cornerKeys.push_back(cornersOf(out.places[i].cell));
    }

    // An edge between two copies merges the corners that both have.
    DisjointSets points(4 * cornerKeys.size());
    std::vector<int> joined(cornerKeys.size(), kNone); // per copy: the lower-numbered copy that it was joined to last
    for (auto [a, b] : graph.edges) {
        const auto [low, high] = std::minmax(copy[a], copy[b]);
        if (low == high || joined[high] == low) continue; // most edges between two copies follow each other
        joined[high] = low;
        // The keys of a cell's corners are in ascending order.
        for (int i = 0, j = 0; i < 4 && j < 4;) {
            const Key one = cornerKeys[low][i], other = cornerKeys[high][j];
            if (one == other) points.join(4 * low + i, 4 * high + j);
            i += one <= other;
            j += other <= one;
        }
    }

    std::vector<int> number(4 * cornerKeys.size(), kNone);
    out.corners.assign(graph.nodes.size(), {kNone, kNone, kNone, kNone});
    for (int i = 0; i < n; ++i)
        for (int k = 0; k < 4; ++k) {
            if (out.places[i].weights[k] < kMinWeight) continue;
            int& point = number[points.find(4 * copy[i] + k)];
            if (point == kNone) point = out.count++;
            out.corners[i][k] = point;
        }
}

// Which coarse nodes support enough of the body, compared with the median node of their piece.
std::vector<bool> strongEnough(const Graph& graph, const LatticeLayout& laid)
{
    std::vector<double> support(laid.count, 0.0);
    std::vector<int> piece(laid.count, 0);
    for (std::size_t i = 0; i < laid.corners.size(); ++i)
        for (int k = 0; k < 4; ++k)
            if (const int corner = laid.corners[i][k]; corner != kNone) {
                support[corner] += laid.places[i].weights[k];
                piece[corner] = graph.piece[i];
            }
    std::vector<std::vector<double>> ofPiece(graph.box.size());
    for (int c = 0; c < laid.count; ++c) ofPiece[piece[c]].push_back(support[c]);
    std::vector<double> minimum;
    for (std::vector<double>& supports : ofPiece) {
        const auto middle = supports.begin() + static_cast<std::ptrdiff_t>(supports.size() / 2);
        std::nth_element(supports.begin(), middle, supports.end());
        minimum.push_back(kMinSupport * *middle);
    }
    std::vector<bool> strong(laid.count);
    for (int c = 0; c < laid.count; ++c) strong[c] = support[c] >= minimum[piece[c]];
    return strong;
}

// Drops the weak coarse nodes: they cost as much as the others, and a coarse node that only one or two nodes use makes
// the Galerkin matrix singular. Using finer cells instead saved up to a quarter of the iterations (bunnies, a beam, a
// membrane; block Jacobi plus this lattice) and cost 4 % at worst. A limit of 0.1 slowed a static membrane.
void dropWeak(const Graph& graph, LatticeLayout& laid)
{
    std::vector<bool> strong = strongEnough(graph, laid);
    // If a node would be left with too little weight, its largest corner is kept.
    for (std::size_t i = 0; i < laid.corners.size(); ++i) {
        const std::array<double, 4>& weights = laid.places[i].weights;
        double kept = 0.0;
        for (int k = 0; k < 4; ++k)
            if (laid.corners[i][k] != kNone && strong[laid.corners[i][k]]) kept += weights[k];
        const auto largest = std::ranges::max_element(weights) - weights.begin();
        if (kept < kMinKeptWeight) strong[laid.corners[i][largest]] = true;
    }
    std::vector<int> number(laid.count, kNone);
    laid.count = 0;
    for (std::size_t c = 0; c < number.size(); ++c)
        if (strong[c]) number[c] = laid.count++;
    for (std::array<int, 4>& corners : laid.corners)
        for (int& corner : corners)
            if (corner != kNone) corner = number[corner];
}

LatticeLayout lay(const Graph& graph, const Cells& cells)
{
    LatticeLayout laid;
    placeNodes(graph, cells, laid);
    connect(graph, laid);
    dropWeak(graph, laid);
    return laid;
}

// Searches for the lattice whose count is nearest to `target`, at most 5 % above it.
class Search {
public:
    Search(const Graph& graph, int target) : graph_(graph), target_(target)
    {
        for (const Box& box : graph.box) extent_ = std::max(extent_, longestSide(box));
        // Between one tetrahedron per piece and cells of a piece's size there is a gap in the counts, too wide for a
        // body of few pieces.
        if (16 * static_cast<int>(graph.box.size()) <= target) cells_.fit = 2.0;
        best_ = lay(graph_, {2.0 * extent_, cells_.shift, cells_.fit});
    }

    LatticeLayout run()
    {
        // The count jumps when the body's sides coincide with lattice planes: then other offsets of the lattice are
        // tried.
        for (int attempt = 0; attempt < 4 && !isNear(0.1); ++attempt) {
            const double golden =
                0.61803398875 * attempt; // never a whole number, so that no side lies in a lattice plane
            cells_.shift = {1.37 + golden - std::floor(golden), 1.47, 1.77};
            bisect();
        }
        return std::move(best_);
    }

private:
    bool isNear(double share) const { return std::abs(best_.count - target_) <= share * target_; }

    // Lays a lattice with this cube; true if it has at most `target` coarse nodes.
    bool fits(double cube)
    {
        cells_.cube = cube;
        LatticeLayout laid = lay(graph_, cells_);
        const int count = laid.count;
        const bool nearer = std::abs(count - target_) < std::abs(best_.count - target_);
        if (nearer && 20 * count <= 21 * target_) best_ = std::move(laid);
        return count <= target_;
    }

    void bisect()
    {
        double large = 2.0 * extent_, small = extent_;
        const double smallest = std::max(large * std::exp2(-kHalvings), 1.0 / kMaxLatticeCoordinate);
        while (small > smallest && fits(small)) {
            large = small;
            small *= 0.5;
        }
        for (int i = 0; i < 12 && small > smallest && !isNear(0.01); ++i) {
            const double middle = std::sqrt(small) * std::sqrt(large);
            (fits(middle) ? large : small) = middle;
        }
    }

    const Graph& graph_;
    int target_;
    double extent_ = 0.0;
    Cells cells_;
    LatticeLayout best_;
};

// Weights in single precision that sum to 1 whatever was dropped; unused corners name a used one.
void write(const std::vector<int>& original, const LatticeLayout& laid, CoarseLattice& out)
{
    for (std::size_t i = 0; i < original.size(); ++i) {
        const std::array<int, 4>& corners = laid.corners[i];
        const int used = *std::ranges::max_element(corners);
        double sum = 0.0;
        for (int k = 0; k < 4; ++k)
            if (corners[k] != kNone) sum += laid.places[i].weights[k];
        for (int k = 0; k < 4; ++k) {
            const bool isUsed = corners[k] != kNone;
            out.corners[original[i]][k] = isUsed ? corners[k] : used;
            out.weights[original[i]][k] = isUsed ? static_cast<float>(laid.places[i].weights[k] / sum) : 0.0f;
        }
    }
}

} // namespace

CoarseLattice coarseLattice(std::span<const Vec3> nodes, std::span<const std::array<int, 2>> edges,
                            const std::vector<bool>& active, int target)
{
    FILASOFIA_ASSERT(active.size() == nodes.size());
    CoarseLattice lattice{0, std::vector<std::array<int, 4>>(nodes.size()),
                          std::vector<std::array<float, 4>>(nodes.size())};
    Graph graph = subgraph(nodes, edges, [&](int i) { return active[i]; });
    const auto isUsable = [](Vec3 p) {
        return isFinite(p) && std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < kMaxLatticeCoordinate;
    };
    if (graph.nodes.empty() || target < 4 || !std::ranges::all_of(graph.nodes, isUsable)) return lattice;
    findPieces(graph);
    const Budget budget = budgetOf(graph, target);
    if (!coversHalf(graph, budget)) return lattice;

    if (budget.laid > 0) {
        Graph large = subgraph(graph.nodes, graph.edges, [&](int i) { return graph.piece[i] < budget.laid; });
        findPieces(large);
        for (int& node : large.original) node = graph.original[node];
        const LatticeLayout laid = Search(large, budget.target - budget.single).run();
        write(large.original, laid, lattice);
        lattice.nodeCount = laid.count;
    }
    lattice.pieces.resize(static_cast<std::size_t>(budget.small));
    std::vector<int> single(graph.pieceSize.size(), kNone); // coarse nodes
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        const int piece = graph.piece[i], node = graph.original[i];
        if (budget.isSmall(piece)) lattice.pieces[piece - budget.large].push_back(node);
        if (!budget.isSingle(piece)) continue;
        if (single[piece] == kNone) single[piece] = lattice.nodeCount++;
        lattice.corners[node].fill(single[piece]);
        lattice.weights[node][0] = 1.0f;
    }
    return lattice;
}

} // namespace filasofia::geometry
