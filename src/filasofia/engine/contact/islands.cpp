#include "filasofia/engine/contact/islands.h"

#include "filasofia/core/disjoint_sets.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

constexpr std::size_t kNoIsland = static_cast<std::size_t>(-1);

} // namespace

std::optional<std::size_t> planPlace(const RigidPlan& plan, const BodyPoint& point)
{
    if (point.of == BodyPoint::Of::Joint) return point.body;
    if (point.of != BodyPoint::Of::Rigid && point.of != BodyPoint::Of::Turning) return std::nullopt;
    if (!plan[point.body].dynamic) return std::nullopt;
    return plan[point.body].articulation < 0 ? point.body : plan[point.body].base;
}

std::optional<std::size_t> unitOf(std::size_t softBodies, const RigidPlan& plan, const BodyPoint& point)
{
    if ((point.of == BodyPoint::Of::Soft && point.count > 0) || point.of == BodyPoint::Of::RodEdge) return point.body;
    const auto place = planPlace(plan, point);
    if (place) return softBodies + *place;
    return std::nullopt;
}

std::vector<Island> findIslands(std::size_t softBodies, const RigidPlan& plan, std::span<const Constraint> constraints,
                                std::span<const char> apart)
{
    const std::size_t soft = softBodies;
    const auto unitAt = [&](const BodyPoint& point) { return unitOf(soft, plan, point).value_or(kNoIsland); };
    DisjointSets sets(soft + plan.size());
    const auto setOf = [&](std::size_t unit) { return static_cast<std::size_t>(sets.find(static_cast<int>(unit))); };
    std::vector<bool> constrained(soft + plan.size());
    const auto isApart = [&](std::size_t c) { return !apart.empty() && apart[c] != 0; };
    for (std::size_t c = 0; c < constraints.size(); ++c) {
        if (isApart(c)) continue;
        const std::size_t a = unitAt(constraints[c].sides[0]), b = unitAt(constraints[c].sides[1]);
        for (std::size_t unit : {a, b})
            if (unit != kNoIsland) constrained[unit] = true;
        if (a != kNoIsland && b != kNoIsland) sets.join(static_cast<int>(a), static_cast<int>(b));
    }

    std::vector<Island> islands;
    std::vector<std::size_t> islandOf(soft + plan.size(), kNoIsland);
    for (std::size_t unit = 0; unit < constrained.size(); ++unit) {
        if (!constrained[unit]) continue;
        std::size_t& island = islandOf[setOf(unit)]; // the least member comes first
        if (island == kNoIsland) {
            island = islands.size();
            islands.emplace_back();
        }
        if (unit < soft)
            islands[island].soft.push_back(unit);
        else
            islands[island].rigid.push_back(unit - soft);
    }
    for (std::size_t c = 0; c < constraints.size(); ++c) {
        std::size_t unit = unitAt(constraints[c].sides[0]);
        if (unit == kNoIsland) unit = unitAt(constraints[c].sides[1]);
        if (unit != kNoIsland && !isApart(c)) islands[islandOf[setOf(unit)]].constraints.push_back(c);
    }
    return islands;
}

} // namespace filasofia::engine
