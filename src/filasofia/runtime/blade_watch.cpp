#include "filasofia/runtime/blade_watch.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/runtime/contact_event.h"

#include <algorithm>

namespace filasofia::runtime {
namespace {

/// Whether the rigid body has a blade in a collision group of a soft body or a rod that cannot be cut.
bool meetsInVain(const physics::BodyDef& tool, const physics::BodyDef& tissue)
{
    const auto* rigid = std::get_if<physics::RigidBodyDef>(&tool);
    if (!rigid) return false;
    const auto hasBlade = [&](int group) {
        return std::ranges::any_of(rigid->collision, [&](const physics::CollisionDef& blade) {
            return blade.cutting && blade.group == group;
        });
    };
    if (const auto* rod = std::get_if<physics::RodBodyDef>(&tissue))
        return !rod->dynamicTopology && rod->collision && hasBlade(rod->collision->group);
    const auto* soft = std::get_if<physics::SoftBodyDef>(&tissue);
    if (!soft || soft->dynamicTopology) return false;
    return std::ranges::any_of(soft->collision,
                               [&](const physics::CollisionDef& skin) { return hasBlade(skin.group); });
}

} // namespace

BladeWatch::BladeWatch(event::EventDispatcher& events, const physics::PhysicsServer& physics)
    : events_(events), physics_(physics),
      observer_(events.on<ContactEvent>([this](const ContactEvent& contact) { look(contact); }))
{
}

BladeWatch::~BladeWatch() { events_.detach(observer_); }

std::vector<std::string> BladeWatch::lines() const
{
    const std::lock_guard lock(mutex_);
    return lines_;
}

void BladeWatch::look(const ContactEvent& contact)
{
    if (contact.kind != ContactEvent::Kind::Begin) return;
    for (const auto& [tool, tissue] :
         {std::pair{contact.pair.first, contact.pair.second}, std::pair{contact.pair.second, contact.pair.first}}) {
        if (!physics_.has(tool) || !physics_.has(tissue)) continue;
        const auto toolDef = physics_.def(tool), tissueDef = physics_.def(tissue);
        if (!meetsInVain(*toolDef, *tissueDef)) continue;
        const std::lock_guard lock(mutex_);
        if (!met_.insert({tool, tissue}).second) continue;
        lines_.push_back(text("blade of '", physics_.nameOf(tool), "' met body '", physics_.nameOf(tissue),
                              "', which has no dynamicTopology: it pushes and does not cut"));
        logWarning(lines_.back());
    }
}

} // namespace filasofia::runtime
