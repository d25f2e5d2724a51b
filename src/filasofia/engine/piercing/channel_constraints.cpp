#include "filasofia/engine/piercing/channels.h"

#include "filasofia/engine/contact/attachment_points.h"
#include "filasofia/engine/contact/pinned_contacts.h"
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

/// [-] How much more stiffly a channel holds a line across it than along it. A needle spreads its load along its
/// length. A thread loads its channel at the mouths alone: with the stiffness that suits needles, 0.4 N drew it 1.4 mm
/// into tissue beside the mouth.
double acrossOf(const LineShape& line) { return line.sharp() ? 1.0 : 10.0; }

/// A spring across the line, whose force along it is bounded by friction.
Constraint shaftOf(const Threading& at, std::size_t k, double dt, const Scene& scene, const RigidPlan& plan)
{
    const PunctureModel& law = at.law();
    const ChannelPoint& point = at.channel.points[k];
    const double place = at.places[k], share = at.lengthAt(k);
    const LineShape& line = at.lines.at(place);
    Constraint shaft;
    shaft.kind = ConstraintKind::Shaft;
    shaft.sides = {softPoint(point.nodes, at.body, at.tissue.state), line.pointAt(place, scene, plan)};
    shaft.frame = frameOf(line.forward(place));
    shaft.bias = 1.0 / dt * inFrame(shaft.frame, shaft.sides[0].position - shaft.sides[1].position);
    shaft.bias.x = (point.held - place) / dt; // how far the tissue has come towards the tip since it stuck
    shaft.softness = dt * dt * law.stiffness * std::max(share, kLeastShare * at.channel.spacing);
    shaft.across = acrossOf(line);
    // Coulomb's part follows what pressed in the last step. With that of this step, friction and pressure feed each
    // other within the solve: with a thread in tissue it took two to three times the iterations of one without.
    const double mu = std::sqrt(at.tissue.model.friction * frictionOf(scene, bodyAt(scene, at.channel, place)));
    shaft.maxImpulse = dt * ((point.slides ? law.friction : law.staticFriction) * share + mu * point.pressed);
    return shaft;
}

/// A spring from the deepest place that the tip has reached; it pushes with the force that cuts, at most.
Constraint tipOf(const Threading& at, const LineShape& needle, double dt, const Scene& scene, const RigidPlan& plan)
{
    Constraint tip;
    tip.kind = ConstraintKind::Tip;
    tip.sides = {softPoint(at.channel.end, at.body, at.tissue.state), needle.pointAt(0.0, scene, plan)};
    tip.frame = frameOf(needle.forward(0.0));
    tip.bias.x = dot(tip.frame[0], tip.sides[0].position - tip.sides[1].position) / dt;
    tip.softness = dt * dt * at.law().cutting / giveOf(at.law(), needle);
    tip.maxImpulse = dt * at.law().cutting;
    return tip;
}

/// How a contact between tissue and a line of its channel is related to the channel.
enum class Beside { Not, Mouth, Inside };

struct Relation {
    Beside beside = Beside::Not;
    const LineShape* line = nullptr;
};

/// Whether the tissue pushes a line's front back: it is about to pierce another surface.
bool facesTip(const LineShape& line, double place, double margin, Vec3 normal)
{
    constexpr double kFacing = -0.5; // [-] cosine
    return place < line.begin() + margin && dot(normal, line.forward(line.begin())) < kFacing;
}

/// `side`: that of the line.
Beside relation(const Threading& at, const LineShape& line, const Constraint& contact, std::size_t side)
{
    const auto [place, distance] = line.beside(contact.sides[side]);
    const double proximity = contact.contact.proximity, margin = 2.0 * (line.radius() + proximity);
    if (distance > 2.0 * line.radius() + proximity) return Beside::Not; // a hub, a handle
    const double entry = at.places.front(), exit = at.places.back();
    if (at.channel.through && place < exit) {
        const Vec3 normal = (side == 0 ? 1.0 : -1.0) * contact.frame[0];
        if (facesTip(line, place, margin, normal)) return Beside::Not;
    }
    if (place < entry + margin && (!at.channel.through || place > exit - margin)) return Beside::Inside;
    // A taut thread bends its channel at the mouth, and leaves it below the surface. Contacts that would part them at
    // once work against the channel: up to 60 iterations, and impulses that grow without end.
    constexpr double kMouth = 4.0; // margins
    const bool near = place < entry + kMouth * margin && (!at.channel.through || place > exit - kMouth * margin);
    return near ? Beside::Mouth : Beside::Not;
}

Relation relation(const Threading& at, const Constraint& contact, const Scene& scene, const RigidPlan& plan)
{
    const std::array<BodyId, 2> bodies{contact.contact.cached.first, contact.contact.cached.second};
    for (const std::size_t side : {0, 1}) {
        if (bodies[1 - side] != at.channel.tissue) continue;
        const LineShape* line = at.lines.find(bodies[side]);
        if (!line) continue;
        const BodyPoint& point = contact.sides[side];
        if (point.of == BodyPoint::Of::Rigid &&
            plan[point.body].element != scene.rigid[plan[point.body].body].model.needle->element)
            continue;
        if (point.of == BodyPoint::Of::Soft && !line->hasNode(point.nodes[0])) continue; // another piece of it
        return {relation(at, *line, contact, side), line};
    }
    return {};
}

} // namespace

void leaveToChannels(double dt, const Scene& scene, Coupling& coupling, std::size_t begin)
{
    for (const Channel& channel : scene.channels) {
        const Threading at(scene, channel);
        if (at.places.empty()) continue;
        const auto isInside = [&](Constraint& contact) {
            const auto [beside, line] = relation(at, contact, scene, coupling.rigid);
            if (beside == Beside::Mouth && dt > 0.0 && contact.softness == 0.0) {
                const Vec3 last = contact.impulse;
                yieldAsSpring(dt, acrossOf(*line) * at.law().stiffness * channel.spacing, contact);
                contact.impulse = {0.0, last.y, last.z}; // friction starts from that of the last step
            }
            return beside == Beside::Inside;
        };
        eraseContacts(isInside, coupling, begin);
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
