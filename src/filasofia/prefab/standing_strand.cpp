#include "filasofia/prefab/standing_strand.h"

namespace filasofia::prefab {
namespace {

constexpr double kFree = 1.5e-3; ///< [m] over the place: what is lower is no free strand

} // namespace

StandingStrand standingStrand(const frame::SoftBodyFrame& thread, int from, int to, Vec3 place, Vec3 up)
{
    const auto at = [&](int node) { return thread.positions[static_cast<std::size_t>(node)]; };
    const int inwards = to > from ? 1 : -1;
    StandingStrand strand{.base = from};
    while (strand.base != to && dot(at(strand.base) - place, up) > kFree) {
        strand.length += distance(at(strand.base), at(strand.base + inwards));
        strand.base += inwards;
    }
    return strand;
}

std::vector<int> fingerNodes(const frame::SoftBodyFrame& thread, int from, const StandingStrand& strand,
                             const FingersOn& fingers)
{
    const auto at = [&](int node) { return thread.positions[static_cast<std::size_t>(node)]; };
    const int inwards = strand.base > from ? 1 : -1;
    std::vector<int> nodes;
    double left = 0.0;
    for (int node = from; node != strand.base && std::ssize(nodes) < fingers.most; node += inwards) {
        left += distance(at(node), at(node + inwards));
        if (left < fingers.apart || !fingers.wanted(at(node))) continue;
        nodes.push_back(node);
        left = 0.0;
    }
    return nodes;
}

} // namespace filasofia::prefab
