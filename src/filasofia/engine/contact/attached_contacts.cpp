#include "filasofia/core/log.h"
#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/body/find_body.h"

#include <algorithm>
#include <map>
#include <utility>

/// Where contacts and attachments meet.
namespace filasofia::engine {
namespace {

/// What is held, by the point of a contact on it.
AttachedPoint attachedPoint(const BodyPoint& side, Vec3 position, const State& state, const RigidPlan& plan)
{
    AttachedPoint point;
    if (side.of == BodyPoint::Of::Soft) {
        for (std::size_t k = 0; k < static_cast<std::size_t>(side.count); ++k)
            point.nodes.push_back({side.nodes[k], side.weights[k]});
        return point;
    }
    const RigidPlanElement& planned = plan[side.body];
    point.element = static_cast<int>(planned.element);
    point.place = transform(inverse(state.rigidBodies[planned.body].poses[planned.element]), position);
    return point;
}

/// A point of a body where it really is: contacts look at surfaces a little inside themselves.
Vec3 placeOf(const BodyPoint& point, const State& state)
{
    if (point.of != BodyPoint::Of::Soft) return point.position;
    Vec3 place;
    for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k)
        place += point.weights[k] * state.softBodies[point.body].x[static_cast<std::size_t>(point.nodes[k])];
    return place;
}

void grasp(const PendingGrasp& wanted, const Model& model, State& state, const Coupling& coupling,
           physics::StepReport& report)
{
    Attachment attachment{wanted.id, wanted.target, wanted.rigid, {}, wanted.stiffness, wanted.breakForce};
    std::vector<Vec3> forces;
    for (std::size_t c = 0; c < coupling.contacts.size(); ++c) {
        const ContactMemory& contact = coupling.contacts[c].memory;
        const bool targetFirst = contact.first == wanted.target && contact.second == wanted.rigid;
        if (!targetFirst && !(contact.first == wanted.rigid && contact.second == wanted.target)) continue;
        if (!(coupling.contacts[c].gap < coupling.contacts[c].proximity)) continue;
        // Both are held where the target is: glued as they are, and not drawn together.
        const BodyPoint& target = coupling.links[c].sides[targetFirst ? 0 : 1];
        const BodyPoint& rigid = coupling.links[c].sides[targetFirst ? 1 : 0];
        const Vec3 place = placeOf(target, state);
        attachment.pairs.push_back(
            {attachedPoint(target, place, state, coupling.rigid), attachedPoint(rigid, place, state, coupling.rigid)});
        forces.push_back(targetFirst ? contact.force : -contact.force);
    }
    if (!attachment.pairs.empty()) return addAttachment(std::move(attachment), std::move(forces), state);
    report.set(physics::StepFlag::NothingAttached);
    logWarning("rigid body '", model.rigidBodies[findBody(model, wanted.rigid)->index].name,
               "': grasp.target: it does not touch body ", wanted.target.value, "; nothing is held");
}

/// What one hard attachment holds of its two bodies.
struct HeldPair {
    BodyId body, to;
    std::array<std::vector<int>, 2> nodes;        ///< ascending; of soft bodies
    std::map<std::array<int, 2>, int> elements{}; ///< pairs of elements, and by how many points they hold each other
};

HeldPair heldPairOf(const Attachment& attachment)
{
    HeldPair grip{attachment.body, attachment.to, {}};
    for (const auto& pair : attachment.pairs) {
        for (std::size_t side = 0; side < 2; ++side)
            for (const NodeWeight& each : pair[side].nodes) grip.nodes[side].push_back(each.node);
        ++grip.elements[{pair[0].element, pair[1].element}];
    }
    for (std::vector<int>& nodes : grip.nodes) std::sort(nodes.begin(), nodes.end());
    return grip;
}

/// Can the two sides of a contact not move against each other, for all that is held.
bool holds(const HeldPair& grip, bool turned, const Link& link, const RigidPlan& plan)
{
    std::array<int, 2> elements{};
    bool soft = false;
    for (std::size_t side = 0; side < 2; ++side) {
        const BodyPoint& point = link.sides[turned ? 1 - side : side];
        if (point.of == BodyPoint::Of::Soft) {
            soft = true;
            for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k)
                if (!std::binary_search(grip.nodes[side].begin(), grip.nodes[side].end(), point.nodes[k])) return false;
        } else {
            elements[side] = static_cast<int>(plan[point.body].element);
        }
    }
    const auto found = grip.elements.find(elements);
    return found != grip.elements.end() && (soft || found->second >= 3);
}

} // namespace

void graspContacts(const Model& model, State& state, const Coupling& coupling, physics::StepReport& report)
{
    for (const PendingGrasp& wanted : state.grasps) grasp(wanted, model, state, coupling, report);
    state.grasps.clear();
}

void leaveToAttachments(const State& state, Coupling& coupling)
{
    if (coupling.contacts.empty()) return;
    std::vector<HeldPair> grips;
    for (const Attachment& attachment : state.attachments)
        if (attachment.to && attachment.stiffness == physics::kHard) grips.push_back(heldPairOf(attachment));
    std::size_t kept = 0;
    for (std::size_t c = 0; c < coupling.contacts.size(); ++c) {
        const BodyId first = coupling.contacts[c].memory.first, second = coupling.contacts[c].memory.second;
        Link& link = coupling.links[c];
        bool gone = false;
        for (const HeldPair& grip : grips) {
            const bool turned = first == grip.to && second == grip.body;
            if (!turned && !(first == grip.body && second == grip.to)) continue;
            link.bias.x = std::max(link.bias.x, 0.0);
            gone = gone || holds(grip, turned, link, coupling.rigid);
        }
        if (gone) continue;
        if (kept != c) {
            coupling.contacts[kept] = coupling.contacts[c];
            coupling.links[kept] = link;
        }
        ++kept;
    }
    coupling.contacts.resize(kept);
    coupling.links.resize(kept);
}

} // namespace filasofia::engine
