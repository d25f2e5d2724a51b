#include "filasofia/engine/contact/islands.h"

#include <algorithm>
#include <numeric>

namespace filasofia::engine {
namespace {

constexpr std::size_t kNoIsland = static_cast<std::size_t>(-1);

/// Disjoint sets; each is represented by its least member.
class Sets {
public:
    explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
    std::size_t find(std::size_t i)
    {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void merge(std::size_t a, std::size_t b)
    {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::size_t> parent_;
};

} // namespace

std::optional<std::size_t> planPlace(const RigidPlan& plan, const BodyPoint& point)
{
    if (point.of == BodyPoint::Of::Joint) return point.body;
    if (point.of != BodyPoint::Of::Rigid && point.of != BodyPoint::Of::Turning) return std::nullopt;
    if (!plan[point.body].dynamic) return std::nullopt;
    return plan[point.body].articulation < 0 ? point.body : plan[point.body].base;
}

std::vector<Island> findIslands(std::size_t softBodies, const RigidPlan& plan, std::span<const Constraint> constraints)
{
    const std::size_t soft = softBodies;
    const auto unitOf = [&](const BodyPoint& point) { // soft bodies, then the plan's elements
        if ((point.of == BodyPoint::Of::Soft && point.count > 0) || point.of == BodyPoint::Of::RodEdge)
            return point.body;
        const auto place = planPlace(plan, point);
        return place ? soft + *place : kNoIsland;
    };
    Sets sets(soft + plan.size());
    std::vector<bool> constrained(soft + plan.size());
    for (const Constraint& each : constraints) {
        const std::size_t a = unitOf(each.sides[0]), b = unitOf(each.sides[1]);
        for (std::size_t unit : {a, b})
            if (unit != kNoIsland) constrained[unit] = true;
        if (a != kNoIsland && b != kNoIsland) sets.merge(a, b);
    }

    std::vector<Island> islands;
    std::vector<std::size_t> islandOf(soft + plan.size(), kNoIsland);
    for (std::size_t unit = 0; unit < constrained.size(); ++unit) {
        if (!constrained[unit]) continue;
        std::size_t& island = islandOf[sets.find(unit)]; // the least member comes first
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
        std::size_t unit = unitOf(constraints[c].sides[0]);
        if (unit == kNoIsland) unit = unitOf(constraints[c].sides[1]);
        if (unit != kNoIsland) islands[islandOf[sets.find(unit)]].constraints.push_back(c);
    }
    return islands;
}

} // namespace filasofia::engine
