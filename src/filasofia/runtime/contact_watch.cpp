#include "filasofia/runtime/contact_watch.h"

#include "filasofia/core/error.h"
#include "filasofia/physics/physics_server.h"

#include <algorithm>

namespace filasofia::runtime {

std::string nameOf(BodyId id, const physics::PhysicsServer& physics)
{
    const std::string name = physics.nameOf(id);
    return physics.has(id) ? name : name + " (removed)";
}

std::optional<event::MergeKey> ContactEvent::mergeKey() const
{
    if (kind != Kind::Persist) return std::nullopt;
    return event::MergeKey{type, std::uint64_t{pair.first.value} << 32 | pair.second.value};
}

void ContactWatch::Watched::count(bool solved)
{
    ++steps;
    if (!solved) {
        ++unsolved;
        maxUnsolved = std::max(maxUnsolved, now.normalForce);
        return;
    }
    normal += now.normalForce;
    friction += now.frictionForce;
    maxNormal = std::max(maxNormal, now.normalForce);
    maxFriction = std::max(maxFriction, now.frictionForce);
}

void ContactWatch::beginRun()
{
    std::erase_if(pairs_, [](const auto& each) { return !each.second.touched; });
    for (auto& [bodies, pair] : pairs_) pair = {.now = pair.now, .touched = true};
}

bool ContactWatch::concerns(const physics::StepReport& report) const
{
    return report.dt > 0.0 && (report.contacts.active > 0 || touching_ > 0); // a paused step changes nothing
}

bool ContactWatch::observe(const std::vector<frame::Contact>& contacts, bool solved, const Post& post)
{
    for (auto& [bodies, pair] : pairs_) pair.touches = false;
    for (const frame::ContactPair& now : frame::contactPairs(contacts)) {
        if (now.contacts == 0) continue;
        Watched& pair = pairs_[{now.first, now.second}];
        pair.touches = true;
        pair.now = now;
        pair.count(solved);
    }
    for (const frame::Contact& contact : contacts) {
        if (contact.gap >= 0.0) continue;
        const auto pair = pairs_.find({contact.first, contact.second});
        if (pair == pairs_.end() || !pair->second.touches) continue;
        pair->second.deepest = std::max(pair->second.deepest, -contact.gap);
    }

    bool all = true;
    touching_ = 0;
    for (auto& [bodies, pair] : pairs_) {
        touching_ += pair.touches ? 1 : 0;
        if (!pair.touches && !pair.touched) continue;
        if (!pair.touches) pair.now = {.first = bodies.first, .second = bodies.second};
        auto event = std::make_unique<ContactEvent>();
        using Kind = ContactEvent::Kind;
        event->kind = !pair.touched ? Kind::Begin : pair.touches ? Kind::Persist : Kind::End;
        event->pair = pair.now;
        all = post(std::move(event)) && all;
        pair.touched = pair.touches;
    }
    return all;
}

std::vector<ContactPairReport> ContactWatch::report(const physics::PhysicsServer& physics) const
{
    std::vector<ContactPairReport> all;
    for (const auto& [bodies, pair] : pairs_) {
        if (pair.steps == 0) continue;
        const auto solved = static_cast<double>(std::max<std::uint64_t>(pair.steps - pair.unsolved, 1));
        all.push_back({.first = nameOf(bodies.first, physics),
                       .second = nameOf(bodies.second, physics),
                       .steps = pair.steps,
                       .meanNormalForce = pair.normal / solved,
                       .maxNormalForce = pair.maxNormal,
                       .meanFrictionForce = pair.friction / solved,
                       .maxFrictionForce = pair.maxFriction,
                       .deepest = pair.deepest,
                       .unsolved = pair.unsolved,
                       .maxUnsolvedForce = pair.maxUnsolved});
    }
    return all;
}

} // namespace filasofia::runtime
