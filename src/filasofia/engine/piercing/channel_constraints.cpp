#include "filasofia/engine/piercing/channels.h"

#include "filasofia/engine/contact/attachment_points.h"
#include "filasofia/engine/piercing/threading.h"
#include "filasofia/engine/scene/find_body.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

// A point near the tip stands for little of the line, but holds it sideways with at least this share of the spacing.
constexpr double kLeastShare = 0.5;

double frictionOf(const Scene& scene, BodyId id)
{
    const BodyPlace place = *findBody(scene, id);
    return place.soft ? scene.soft[place.index].model.friction : scene.rigid[place.index].model.friction;
}

/// A spring across the line, whose force along it is bounded by friction.
Constraint shaftOf(const Threading& at, std::size_t k, double dt, const Scene& scene, const RigidPlan& plan)
{
    const PunctureModel& law = at.law();
    const ChannelPoint& point = at.channel.points[k];
    const double place = at.places[k], share = at.lengthAt(k);
    const LineShape& line = at.lines.at(place);
    Constraint shaft{.kind = ConstraintKind::Shaft};
    shaft.sides = {softPoint(point.nodes, at.body, at.tissue.state), line.pointAt(place, scene, plan)};
    shaft.frame = frameOf(line.forward(place));
    shaft.bias = 1.0 / dt * inFrame(shaft.frame, shaft.sides[0].position - shaft.sides[1].position);
    shaft.bias.x = (point.held - place) / dt; // how far the tissue has come towards the tip since it stuck
    shaft.softness = dt * dt * law.stiffness * std::max(share, kLeastShare * spacingOf(scene, at.channel));
    // Coulomb's part follows what pressed in the last step. With that of this step, friction and pressure feed each
    // other within the solve: with a thread in tissue it took two to three times the iterations of one without.
    const double mu = std::sqrt(at.tissue.model.friction * frictionOf(scene, bodyAt(scene, at.channel, place)));
    shaft.maxImpulse = dt * ((point.slides ? law.friction : law.staticFriction) * share + mu * point.pressed);
    return shaft;
}

/// A spring from the deepest place that the tip has reached; it pushes with the force that cuts, at most.
Constraint tipOf(const Threading& at, const LineShape& needle, double dt, const Scene& scene, const RigidPlan& plan)
{
    Constraint tip{.kind = ConstraintKind::Tip};
    tip.sides = {softPoint(at.channel.end, at.body, at.tissue.state), needle.pointAt(0.0, scene, plan)};
    tip.frame = frameOf(needle.forward(0.0));
    tip.bias.x = dot(tip.frame[0], tip.sides[0].position - tip.sides[1].position) / dt;
    tip.softness = dt * dt * at.law().cutting / giveOf(at.law(), needle);
    tip.maxImpulse = dt * at.law().cutting;
    return tip;
}

/// Whether a contact is at the part of a line that runs through a channel, or at the channel's mouths.
bool isIn(const Threading& at, const Constraint& contact, const Scene& scene, const RigidPlan& plan)
{
    const CachedContact& pair = contact.contact.cached;
    for (const ThreadedLine& line : at.channel.lines) {
        const bool second = pair.first == at.channel.tissue && pair.second == line.body;
        if (!second && !(pair.second == at.channel.tissue && pair.first == line.body)) continue;
        const BodyPoint& point = contact.sides[second ? 1 : 0];
        if (point.of == BodyPoint::Of::Rigid &&
            plan[point.body].element != scene.rigid[plan[point.body].body].model.needle->element)
            return false;
        const LineShape& shape = *at.lines.find(line.body);
        if (point.of == BodyPoint::Of::Soft && !shape.hasNode(point.nodes[0])) continue; // another piece of it
        const double place = shape.nearest(point.position);
        const double margin = 2.0 * (shape.radius() + contact.contact.proximity);
        return place < at.places.front() + margin && (!at.channel.through || place > at.places.back() - margin);
    }
    return false;
}

} // namespace

void leaveToChannels(const Scene& scene, Coupling& coupling)
{
    for (const Channel& channel : scene.channels) {
        const Threading at(scene, channel);
        if (at.places.empty()) continue;
        const auto contacts = coupling.constraints.begin();
        const auto end = contacts + static_cast<std::ptrdiff_t>(coupling.contactCount);
        const auto kept = std::remove_if(contacts, end,
                                         [&](const Constraint& each) { return isIn(at, each, scene, coupling.rigid); });
        coupling.contactCount = static_cast<std::size_t>(kept - contacts);
        coupling.constraints.erase(kept, end);
    }
}

void addChannels(const StepContext& context, const Scene& scene, Coupling& coupling)
{
    const double dt = context.dt;
    if (dt == 0.0) return;
    const std::size_t before = coupling.constraints.size();
    for (std::size_t c = 0; c < scene.channels.size(); ++c) {
        const Threading at(scene, scene.channels[c]);
        const auto add = [&](Constraint constraint, int point) {
            constraint.channel = {c, point};
            coupling.constraints.push_back(constraint);
        };
        for (std::size_t k = 0; k < at.places.size(); ++k)
            if (at.occupied(k)) add(shaftOf(at, k, dt, scene, coupling.rigid), static_cast<int>(k));
        if (const LineShape* needle = at.cutting(); needle && at.law().cutting > 0.0)
            add(tipOf(at, *needle, dt, scene, coupling.rigid), ChannelInfo::kTip);
    }
    coupling.channelCount = coupling.constraints.size() - before;
}

} // namespace filasofia::engine
