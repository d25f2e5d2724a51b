#include "filasofia/engine/soft/pinned_parts.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

/// True if an element or spring pulls at hard-pinned nodes. If all its nodes are pinned, it is at rest and exerts no
/// force.
template <class Nodes> bool pulls(const PinnedParts& parts, const Nodes& nodes)
{
    const auto held = std::ranges::count_if(nodes, [&](int node) { return parts.holders[node] > 0; });
    return held > 0 && held < std::ssize(nodes);
}

} // namespace

void listVolumes(const SoftModel& model, PinnedParts& parts)
{
    parts.volumes.clear();
    if (!model.nodalVolumes || parts.elements.empty()) return;
    std::vector<bool> reached(model.rest.size());
    for (int e : parts.elements)
        for (int node : model.elements[e].nodes) reached[node] = true;
    for (std::size_t e = 0; e < model.elements.size(); ++e)
        if (std::ranges::any_of(model.elements[e].nodes, [&](int node) { return reached[node]; }))
            parts.volumes.push_back(static_cast<int>(e));
}

PinnedParts pinnedParts(const SoftModel& model)
{
    PinnedParts parts;
    for (const PinGroup& group : model.pins.groups) {
        if (group.stiffness != physics::kHard) continue;
        parts.holders.resize(model.rest.size());
        for (int node : group.nodes) ++parts.holders[node];
    }
    if (parts.holders.empty()) return parts;
    const auto list = [&](const auto& all, std::vector<int>& out) {
        for (std::size_t i = 0; i < all.size(); ++i)
            if (pulls(parts, all[i].nodes)) out.push_back(static_cast<int>(i));
    };
    list(model.elements, parts.elements);
    list(model.springs, parts.springs);
    list(model.shell.membranes, parts.membranes);
    list(model.shell.bends, parts.bends);
    listVolumes(model, parts);
    return parts;
}

void updatePinnedParts(const SoftModel& model, const MeshEdit& edit, PinnedParts& parts)
{
    if (parts.holders.empty()) return;
    if (model.elements.empty()) {
        parts = pinnedParts(model);
        return;
    }
    const std::size_t known = parts.holders.size();
    parts.holders.resize(model.rest.size());
    for (const PinGroup& group : model.pins.groups)
        if (group.stiffness == physics::kHard)
            for (auto node = group.nodes.rbegin(); node != group.nodes.rend();
                 ++node) { // ascending: new nodes are last
                if (static_cast<std::size_t>(*node) < known) break;
                ++parts.holders[static_cast<std::size_t>(*node)];
            }
    for (int element : edit.elements) {
        const auto place = std::ranges::lower_bound(parts.elements, element);
        const bool listed = place != parts.elements.end() && *place == element;
        const bool now = pulls(parts, model.elements[static_cast<std::size_t>(element)].nodes);
        if (now && !listed) parts.elements.insert(place, element);
        if (!now && listed) parts.elements.erase(place);
    }
    listVolumes(model, parts);
}

} // namespace filasofia::engine
