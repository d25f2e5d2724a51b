#include "filasofia/engine/contact/attached_contacts.h"

#include "filasofia/core/log.h"
#include "filasofia/engine/contact/attachment_points.h"
#include "filasofia/engine/contact/attachments.h"
#include "filasofia/engine/scene/find_body.h"

#include <algorithm>
#include <map>
#include <utility>

namespace filasofia::engine {
namespace {

/// The attached point at a contact's position on one side.
AttachedPoint attachedPoint(const BodyPoint& side, Vec3 position, const Scene& scene, const RigidPlan& plan)
{
    AttachedPoint point;
    if (side.of == BodyPoint::Of::Soft) {
        point.nodes = nodeWeights(side);
        return point;
    }
    const RigidPlanElement& planned = plan[side.body];
    point.element = static_cast<int>(planned.element);
    point.place = transform(inverse(scene.rigid[planned.body].state.poses[planned.element]), position);
    return point;
}

/// The actual position of a body's point: contacts see surfaces a little inside the real ones.
Vec3 positionOf(const BodyPoint& point, const Scene& scene)
{
    if (point.of != BodyPoint::Of::Soft) return point.position;
    Vec3 place;
    for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k)
        place += point.weights[k] * scene.soft[point.body].state.x[static_cast<std::size_t>(point.nodes[k])];
    return place;
}

/// Whether a contact is where the body grasps.
bool isGrasped(const PendingGrasp& wanted, const Constraint& constraint, bool targetFirst, const Scene& scene)
{
    if (!wanted.mouth) return true;
    const auto& poses = scene.rigid[findBody(scene, wanted.rigid)->index].state.poses;
    return physics::isInMouth(*wanted.mouth, poses[static_cast<std::size_t>(wanted.mouth->element)],
                              constraint.contact.cached.point,
                              targetFirst ? -constraint.frame[0] : constraint.frame[0]);
}

void grasp(const PendingGrasp& wanted, const Coupling& coupling, Scene& scene, physics::StepReport& report)
{
    Attachment attachment{wanted.id, wanted.target, wanted.rigid, {}, {}, wanted.stiffness, wanted.breakForce};
    attachment.grasp = true;
    std::vector<Vec3> forces;
    for (const Constraint& constraint : coupling.contacts()) {
        const CachedContact& contact = constraint.contact.cached;
        const bool targetFirst = contact.first == wanted.target && contact.second == wanted.rigid;
        if (!targetFirst && !(contact.first == wanted.rigid && contact.second == wanted.target)) continue;
        if (!(constraint.contact.gap < constraint.contact.proximity)) continue;
        if (!isGrasped(wanted, constraint, targetFirst, scene)) continue;
        // Both are attached at the target's place: the gap is kept, they are not drawn together.
        const BodyPoint& target = constraint.sides[targetFirst ? 0 : 1];
        const BodyPoint& rigid = constraint.sides[targetFirst ? 1 : 0];
        const Vec3 place = positionOf(target, scene);
        attachment.pairs.push_back(
            {attachedPoint(target, place, scene, coupling.rigid), attachedPoint(rigid, place, scene, coupling.rigid)});
        forces.push_back(targetFirst ? contact.force : -contact.force);
    }
    if (!attachment.pairs.empty()) return addAttachment(std::move(attachment), std::move(forces), scene);
    report.set(physics::StepFlag::NothingAttached);
    report.nothingHeld.push_back({.id = wanted.id, .body = wanted.rigid, .to = wanted.target, .grasp = true});
    logWarning(nameOf(scene, wanted.rigid), ": grasp.target: no contact ", wanted.mouth ? "in its mouth " : "", "with ",
               nameOf(scene, wanted.target), "; nothing is attached");
}

/// The points by which one hard attachment fixes two bodies to each other.
struct FixedPair {
    BodyId body, to;
    std::array<std::vector<int>, 2> nodes; ///< nodes of soft bodies, ascending
    /// pairs of elements, and the number of points that fix them to each other
    std::map<std::array<int, 2>, int> elements{};
};

FixedPair fixedPairOf(const Attachment& attachment)
{
    FixedPair held{attachment.body, attachment.to, {}};
    for (const auto& pair : attachment.pairs) {
        for (std::size_t side = 0; side < 2; ++side)
            for (const NodeWeight& each : pair[side].nodes) held.nodes[side].push_back(each.node);
        ++held.elements[{pair[0].element, pair[1].element}];
    }
    for (std::vector<int>& nodes : held.nodes) std::sort(nodes.begin(), nodes.end());
    return held;
}

/// Whether the attachment leaves the two sides of a contact no relative motion.
bool leavesNoMotion(const FixedPair& pair, bool turned, const Constraint& contact, const RigidPlan& plan)
{
    std::array<int, 2> elements{};
    bool soft = false;
    for (std::size_t side = 0; side < 2; ++side) {
        const BodyPoint& point = contact.sides[turned ? 1 - side : side];
        if (point.of == BodyPoint::Of::Soft) {
            soft = true;
            for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k)
                if (!std::binary_search(pair.nodes[side].begin(), pair.nodes[side].end(), point.nodes[k])) return false;
        } else {
            elements[side] = static_cast<int>(plan[point.body].element);
        }
    }
    const auto found = pair.elements.find(elements);
    return found != pair.elements.end() && (soft || found->second >= 3);
}

} // namespace

void graspContacts(const Coupling& coupling, Scene& scene, physics::StepReport& report)
{
    for (const PendingGrasp& wanted : scene.grasps) grasp(wanted, coupling, scene, report);
    scene.grasps.clear();
}

void leaveToAttachments(const Scene& scene, Coupling& coupling)
{
    if (coupling.contactCount == 0) return;
    std::vector<FixedPair> pairs;
    for (const Attachment& attachment : scene.attachments)
        if (attachment.to && attachment.stiffness == physics::kHard) pairs.push_back(fixedPairOf(attachment));
    const auto isGone = [&](Constraint& contact) {
        const BodyId first = contact.contact.cached.first, second = contact.contact.cached.second;
        bool gone = false;
        for (const FixedPair& pair : pairs) {
            const bool turned = first == pair.to && second == pair.body;
            if (!turned && !(first == pair.body && second == pair.to)) continue;
            contact.bias.x = std::max(contact.bias.x, 0.0);
            gone = gone || leavesNoMotion(pair, turned, contact, coupling.rigid);
        }
        return gone;
    };
    eraseContacts(isGone, coupling);
}

} // namespace filasofia::engine
