#include "filasofia/engine/piercing/embed.h"

#include "filasofia/engine/body/elements.h"

#include <algorithm>
#include <array>

namespace filasofia::engine {
namespace {

constexpr double kOutside = -1e-6; ///< [-] a weight down to this counts as inside: faces are shared
constexpr int kRings = 3;          // around a node; a tip is hardly farther from its last place than an element is long

/// The weights of the four corners at a place; negative ones if it is outside. Zeros if the element has no volume.
std::array<double, 4> weightsIn(const geometry::Tetrahedron& nodes, const std::vector<Vec3>& x, Vec3 place)
{
    const auto at = [&](std::size_t k) {
        return x[static_cast<std::size_t>(nodes[k])] - x[static_cast<std::size_t>(nodes[0])];
    };
    const Vec3 a = at(1), b = at(2), c = at(3), p = place - x[static_cast<std::size_t>(nodes[0])];
    const double volume = dot(a, cross(b, c));
    if (!(volume > 0.0)) return {-1.0, -1.0, -1.0, -1.0}; // inside out: it holds nothing
    const std::array<double, 3> w{dot(p, cross(b, c)) / volume, dot(a, cross(p, c)) / volume,
                                  dot(a, cross(b, p)) / volume};
    return {1.0 - w[0] - w[1] - w[2], w[0], w[1], w[2]};
}

/// The element around a place, or the one that it misses least.
struct Found {
    std::size_t element = 0;
    std::array<double, 4> weights{-1.0, -1.0, -1.0, -1.0};
    [[nodiscard]] double least() const { return *std::ranges::min_element(weights); }
};

/// Looks through the elements that share a node with the marked ones, ring by ring.
std::optional<Found> search(Vec3 place, const std::vector<NodeWeight>& near, const SoftModel& tissue,
                            const std::vector<Vec3>& x)
{
    std::vector<char> marked(x.size());
    for (const NodeWeight& each : near) marked[static_cast<std::size_t>(each.node)] = 1;
    std::optional<Found> best;
    for (int ring = 0; ring < kRings; ++ring) {
        std::vector<int> reached;
        for (std::size_t e = 0; e < elementCount(tissue); ++e) {
            const geometry::Tetrahedron& nodes = elementNodes(tissue, e);
            if (std::ranges::none_of(nodes, [&](int node) { return marked[static_cast<std::size_t>(node)] != 0; }))
                continue;
            if (allHeld(tissue, e) && !tissue.removed.empty()) continue;
            const Found found{e, weightsIn(nodes, x, place)};
            if (!best || found.least() > best->least()) best = found;
            reached.insert(reached.end(), nodes.begin(), nodes.end());
        }
        if (best && best->least() >= kOutside) break;
        for (int node : reached) marked[static_cast<std::size_t>(node)] = 1;
    }
    return best;
}

std::vector<NodeWeight> pointOf(const Found& found, const SoftModel& tissue)
{
    std::vector<NodeWeight> point;
    double sum = 0.0;
    for (double each : found.weights) sum += std::max(each, 0.0);
    for (std::size_t k = 0; k < 4; ++k)
        if (const double weight = std::max(found.weights[k], 0.0) / sum; weight > 0.0)
            point.push_back({elementNodes(tissue, found.element)[k], weight});
    return point;
}

} // namespace

std::optional<std::vector<NodeWeight>> embed(Vec3 place, const std::vector<NodeWeight>& near, const SoftModel& tissue,
                                             const std::vector<Vec3>& x)
{
    const auto found = search(place, near, tissue, x);
    if (!found || found->least() < kOutside) return std::nullopt;
    return pointOf(*found, tissue);
}

std::optional<std::vector<NodeWeight>> embedNearest(Vec3 place, const std::vector<NodeWeight>& near,
                                                    const SoftModel& tissue, const std::vector<Vec3>& x)
{
    const auto found = search(place, near, tissue, x);
    if (!found || !(*std::ranges::max_element(found->weights) > 0.0)) return std::nullopt;
    return pointOf(*found, tissue);
}

} // namespace filasofia::engine
