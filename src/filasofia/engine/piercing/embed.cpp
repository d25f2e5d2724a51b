#include "filasofia/engine/piercing/embed.h"

#include "filasofia/engine/body/elements.h"
#include "filasofia/geometry/distance.h"
#include "filasofia/geometry/tet_mesh.h"

#include <algorithm>
#include <array>

namespace filasofia::engine {
namespace {

constexpr double kOutside = -1e-6; ///< [-] a weight down to this counts as inside: faces are shared
constexpr int kRings = 3; // around a node; a tip is hardly ever farther from its last place than an element is long

/// The weights of the four corners at a place, also of an element that is inside out; a negative one if it is outside,
/// or if the element has no volume.
std::array<double, 4> weightsIn(const geometry::Tetrahedron& nodes, const std::vector<Vec3>& x, Vec3 place)
{
    const auto at = [&](std::size_t k) { return x[static_cast<std::size_t>(nodes[k])]; };
    if (geometry::signedVolume(at(0), at(1), at(2), at(3)) == 0.0) return {-1.0, -1.0, -1.0, -1.0};
    return geometry::barycentric(place, at(0), at(1), at(2), at(3));
}

/// The element around a place, or the one that it misses least.
struct Found {
    std::size_t element = 0;
    std::array<double, 4> weights{-1.0, -1.0, -1.0, -1.0};
    [[nodiscard]] double least() const { return *std::ranges::min_element(weights); }
};

bool isGone(const SoftModel& tissue, std::size_t e) { return !tissue.removed.empty() && allHeld(tissue, e); }

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
            if (isGone(tissue, e)) continue;
            const Found found{e, weightsIn(nodes, x, place)};
            if (!best || found.least() > best->least()) best = found;
            reached.insert(reached.end(), nodes.begin(), nodes.end());
        }
        if (best && best->least() >= kOutside) break;
        for (int node : reached) marked[static_cast<std::size_t>(node)] = 1;
    }
    return best;
}

/// Looks through all elements. A tip that has jumped far, or that went from one lip of a wound into the other, is not
/// near its last place.
std::optional<Found> searchAll(Vec3 place, const SoftModel& tissue, const std::vector<Vec3>& x)
{
    for (std::size_t e = 0; e < elementCount(tissue); ++e) {
        const Found found{e, weightsIn(elementNodes(tissue, e), x, place)};
        if (found.least() >= kOutside && !isGone(tissue, e)) return found;
    }
    return std::nullopt;
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
    auto found = search(place, near, tissue, x);
    if (!found || found->least() < kOutside) found = searchAll(place, tissue, x);
    if (!found) return std::nullopt;
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
