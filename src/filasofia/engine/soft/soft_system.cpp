#include "filasofia/engine/soft/soft_system.h"

#include "filasofia/core/log.h"

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

/// Lists the elements whose volumes the elements that pull share.
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

} // namespace

SoftSystem::SoftSystem(const SoftSystem& other)
    : matrixFree(other.matrixFree), rod(other.rod), held(other.held), tuned(other.tuned),
      outdated(other.outdated || other.assembled), forces(other.forces), x(other.x), v(other.v), dv(other.dv),
      residual(other.residual)
{
}

SoftSystem& SoftSystem::operator=(const SoftSystem& other)
{
    if (this != &other) *this = SoftSystem(other);
    return *this;
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

void followTissue(const SoftModel& model, const std::vector<int>& elements, SoftSystem& system)
{
    system.tuned = true;
    listVolumes(model, system.held);
    if (system.outdated) return;
    if (system.matrixFree) system.outdated = !system.matrixFree->editTissue(model, elements);
    if (system.assembled) system.outdated = !system.assembled->holds(model, elements); // it reads them in every step
}

SoftSystem makeSystem(const SoftModel& model, double period)
{
    SoftSystem system;
    for (auto* buffer : {&system.forces, &system.x, &system.v, &system.dv, &system.residual})
        buffer->resize(model.rest.size());
    system.held = pinnedParts(model);
    if (isRod(model)) {
        system.rod = std::make_unique<RodSystem>(model);
        return system;
    }
    const auto* cg = std::get_if<physics::ConjugateGradient>(&model.solver);
    const bool wanted = cg && !cg->assembled;
    if (wanted && MatrixFreeSystem::fits(model, period))
        system.matrixFree = std::make_unique<MatrixFreeSystem>(model, period);
    else
        system.assembled = std::make_unique<AssembledSystem>(model);
    if (wanted && !system.matrixFree)
        logWarning("soft body '", model.name,
                   "': its masses and stiffnesses span too wide a range for single precision; ",
                   "it is solved in double precision, which is slower");
    return system;
}

} // namespace filasofia::engine
