#include "filasofia/sofa/replace_body.h"

#include "filasofia/core/log.h"
#include "filasofia/sofa/make_tie.h"

#include <algorithm>
#include <utility>

namespace filasofia::sofaengine {
namespace {

std::unique_ptr<SoftNode>& placeOf(BodyId id, SofaScene& scene)
{
    return *std::ranges::find(scene.soft, id, [](const auto& each) { return each->id(); });
}

/// In place of those that hold the body.
void replaceTies(BodyId id, std::vector<std::unique_ptr<Tie>> made, SofaScene& scene)
{
    std::erase_if(scene.ties, [&](const auto& each) { return each->holds(id); });
    for (auto& each : made) scene.ties.push_back(std::move(each));
    std::ranges::sort(scene.ties, {}, [](const auto& each) { return each->id(); });
}

} // namespace

BodyDraft draftOf(const SoftNode& body, const SofaScene& scene)
{
    BodyDraft draft{.plan = body.plan(), .settings = body.settings()};
    body.read(draft.state);
    for (const auto& tie : scene.ties)
        if (tie->holds(body.id())) draft.ties.push_back(tie->state());
    return draft;
}

void replaceBody(BodyDraft draft, std::unique_ptr<SoftCuts> cuts, SofaScene& scene, BodyId id)
{
    std::unique_ptr<SoftNode>& place = placeOf(id, scene);
    if (place->isTuned())
        logWarning("soft body '", place->plan().def.name,
                   "': components that tune() has added to its node are gone since its mesh was edited");
    auto other = std::make_unique<SoftNode>(id, std::move(draft.plan), *scene.root, scene.contact);
    other->setCuts(std::move(cuts), draft.settings.tissue);
    other->apply(draft.settings);
    other->write(draft.state);
    std::vector<std::unique_ptr<Tie>> ties;
    std::swap(place, other); // ties look for their bodies in the scene
    try {
        for (const TieState& each : draft.ties) ties.push_back(makeTie(each, scene));
    } catch (...) {
        ties.clear();
        std::swap(place, other);
        throw;
    }
    const PartedSlaves parted(other->node()); // before its contacts go
    scene.contact.forget();
    replaceTies(id, std::move(ties), scene);
    scene.contact.join(place->plan().collision);
    other.reset();
}

void mendBody(BodyId id, SofaScene& scene)
{
    const SoftNode& body = *placeOf(id, scene);
    auto whole = std::make_unique<SoftCuts>(body.cuts()->start);
    if (body.cuts()->history == 0) {
        *body.cuts() = std::move(*whole);
        return;
    }
    BodyDraft draft = draftOf(body, scene);
    makeWhole(*body.cuts(), draft);
    const auto count = static_cast<int>(draft.plan.mesh.nodes.size());
    const auto isNew = [&](const TiePoint& point) { return std::ranges::max(point.nodes) >= count; };
    for (TieState& tie : draft.ties) { // those that were made with nodes of a cut have no place any more
        std::erase_if(tie.whole, [&](const TieRows::Pair& pair) {
            return (tie.body.id == id && isNew(pair.first)) || (tie.to.id == id && isNew(pair.second));
        });
        tie.pairs = tie.whole;
    }
    std::erase_if(draft.ties, [](const TieState& each) { return each.whole.empty(); });
    replaceBody(std::move(draft), std::move(whole), scene, id);
}

} // namespace filasofia::sofaengine
