#include "filasofia/engine/contact/pinned_contacts.h"

#include "filasofia/engine/contact/islands.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

constexpr double kPinned = 0.5; // [-] share of a place that moves with pinned nodes
// [N/m] for each contact: an instrument that is driven into pinned tissue by a millimetre feels 10 N there.
constexpr double kPinnedStiffness = 1e4;

bool isSoft(const BodyPoint& point) { return point.of == BodyPoint::Of::Soft; }

double pinnedShare(const BodyPoint& point, const Scene& scene)
{
    if (!isSoft(point)) return 0.0;
    const std::vector<bool>& pinned = scene.soft[point.body].model.pins.hard;
    double share = 0.0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k)
        if (pinned[static_cast<std::size_t>(point.nodes[k])]) share += point.weights[k];
    return share;
}

/// Whether a solve can move a rigid element in every direction. A jaw can only turn where its base is told: in all
/// other directions it is driven as the base is.
bool movesFreely(const BodyPoint& point, const RigidPlan& plan)
{
    if (!planPlace(plan, point)) return false;
    const RigidPlanElement& element = plan[point.body];
    return element.articulation < 0 || plan[element.base].dynamic;
}

} // namespace

bool canMove(const BodyPoint& point, const Scene& scene, const RigidPlan& plan)
{
    if (!isSoft(point)) return planPlace(plan, point).has_value();
    const std::vector<bool>& pinned = scene.soft[point.body].model.pins.hard;
    const auto nodes = std::span(point.nodes).first(static_cast<std::size_t>(point.count));
    return !std::ranges::all_of(nodes, [&](int node) { return pinned[static_cast<std::size_t>(node)]; });
}

bool arePinned(const Constraint& contact, const Scene& scene)
{
    return std::ranges::all_of(contact.sides, [&](const BodyPoint& point) {
        if (!isSoft(point)) return false;
        const SoftModel& model = scene.soft[point.body].model;
        const bool solid = !model.elements.empty() || !model.tetrahedra.empty();
        return solid && pinnedShare(point, scene) > kPinned;
    });
}

void yieldAsSpring(double dt, double stiffness, Constraint& contact)
{
    contact.softness = dt * dt * stiffness;
    contact.bias = {(contact.contact.gap - contact.contact.skin) / dt, 0.0, 0.0};
    contact.impulse = {};
}

void yieldWherePinned(double dt, const Scene& scene, Coupling& coupling)
{
    for (Constraint& contact : coupling.contacts()) {
        if (contact.softness > 0.0) continue;
        const std::size_t tissue = isSoft(contact.sides[0]) ? 0 : 1;
        const BodyPoint &place = contact.sides[tissue], &other = contact.sides[1 - tissue];
        if (!(pinnedShare(place, scene) > kPinned) || isSoft(other) || movesFreely(other, coupling.rigid)) continue;
        // What has come nearer goes on to push when it stands still: by its last impulse, so the contact remembers it.
        const double nearing = (tissue == 0 ? 1.0 : -1.0) * dot(other.velocity, contact.frame[0]); // [m/s]
        const bool driven = contact.impulse.x > 0.0 || nearing > 0.0;
        if (driven || canMove(place, scene, coupling.rigid)) yieldAsSpring(dt, kPinnedStiffness, contact);
    }
}

} // namespace filasofia::engine
