#include "filasofia/engine/soft/cavity_system.h"

namespace filasofia::engine {
namespace {

template <class Entries> double changeOf(const Entries& entries, const linalg::NodeArray& p)
{
    double sum = 0.0;
    for (const auto& each : entries) {
        const float* at = p[each.slot];
        sum += dot(each.gradient, Vec3{at[0], at[1], at[2]});
    }
    return sum;
}

} // namespace

void CavitySystem::set(std::span<const RankOneStiffness> cavities, std::span<const int> slotOf, int freeNodes,
                       double scale)
{
    rows_.resize(cavities.size());
    for (std::size_t c = 0; c < cavities.size(); ++c) {
        const RankOneStiffness& from = cavities[c];
        Row& row = rows_[c];
        row.weight = scale * from.weight;
        row.entries.clear();
        for (std::size_t i = 0; i < from.nodes.size(); ++i)
            if (const int slot = slotOf[static_cast<std::size_t>(from.nodes[i])]; slot < freeNodes)
                row.entries.push_back({slot, from.gradient[i]});
    }
}

double CavitySystem::multiply(const linalg::NodeArray& p, linalg::NodeArray& q) const
{
    double sum = 0.0;
    for (const Row& row : rows_) {
        if (row.weight == 0.0) continue;
        const double change = changeOf(row.entries, p);
        for (const Entry& each : row.entries) {
            const Vec3 add = row.weight * change * each.gradient;
            float* at = q[each.slot];
            at[0] += static_cast<float>(add.x);
            at[1] += static_cast<float>(add.y);
            at[2] += static_cast<float>(add.z);
        }
        sum += row.weight * change * change;
    }
    return sum;
}

double CavitySystem::curvature(const linalg::NodeArray& p) const
{
    double sum = 0.0;
    for (const Row& row : rows_) {
        const double change = changeOf(row.entries, p);
        sum += row.weight * change * change;
    }
    return sum;
}

} // namespace filasofia::engine
