#include "filasofia/engine/contact/attachments.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/engine/contact/attachment_points.h"
#include "filasofia/engine/body/find_body.h"
#include "filasofia/engine/step/stages.h"

#include <algorithm>
#include <utility>

namespace filasofia::engine {
namespace {

// Points that have drifted apart come together at this share of the way per step, and not faster than that. Beyond,
// they are pulled at, but the pull is not carried on: where they cannot come together it would grow without end.
constexpr double kRecovery = 0.1;
constexpr double kRecoverySpeed = 1.0; ///< [m/s]
constexpr double kSlack = 1e-5;        ///< [m] that a hard pair may move apart in a step before its impulse is raised
constexpr double kInVain = 0.05;       ///< a recovery is, that comes to less than this share of what was asked for

constexpr std::array<Vec3, 3> kWorldAxes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};

bool isHard(const Attachment& attachment) { return attachment.stiffness == physics::kHard; }

std::string nameOf(const Model& model, BodyId id)
{
    const auto place = findBody(model, id);
    if (!place) return text("body ", id.value);
    if (place->soft) return text("soft body '", model.softBodies[place->index].name, "'");
    return text("rigid body '", model.rigidBodies[place->index].name, "'");
}

/// The regions of a Def, as its fields are called.
std::string regionsOf(const physics::AttachmentDef& def)
{
    std::string names;
    for (const auto& [name, given] :
         {std::pair{"box", def.box.has_value()}, {"ball", def.ball.has_value()}, {"within", def.within.has_value()}})
        if (given) names += text(names.empty() ? "" : ", ", name);
    return names.empty() ? "to" : names;
}

/// Where attached points are now, and how they move.
class Places {
public:
    Places(const Model& model, const State& state, const RigidPlan& plan)
        : state_(state), plan_(plan), firstElement_(firstElements(model))
    {
    }

    [[nodiscard]] BodyPoint of(const AttachedPoint& point, const std::optional<BodyPlace>& body) const
    {
        BodyPoint out;
        if (!body) {
            out.position = point.place;
        } else if (body->soft) {
            const SoftState& soft = state_.softBodies[body->index];
            out.of = BodyPoint::Of::Soft;
            out.body = body->index;
            for (const NodeWeight& each : point.nodes) {
                out.add(each.node, each.weight);
                out.position += each.weight * soft.x[static_cast<std::size_t>(each.node)];
                out.velocity += each.weight * soft.v[static_cast<std::size_t>(each.node)];
            }
        } else {
            const auto element = static_cast<std::size_t>(point.element);
            out.of = BodyPoint::Of::Rigid;
            out.body = firstElement_[body->index] + element;
            out.position = transform(state_.rigidBodies[body->index].poses[element], point.place);
            const RigidPlanElement& planned = plan_[out.body];
            out.velocity = planned.velocity + cross(planned.angularVelocity, out.position - planned.centre);
        }
        return out;
    }

private:
    const State& state_;
    const RigidPlan& plan_;
    std::vector<std::size_t> firstElement_;
};

/// [m/s] What a hard pair's gap asks for.
Vec3 recovery(Vec3 gap, double dt)
{
    const Vec3 bias = kRecovery / dt * gap;
    const double speed = length(bias);
    return speed > kRecoverySpeed ? kRecoverySpeed / speed * bias : bias;
}

Link linkOf(const Attachment& attachment, double dt, Vec3 carried, const std::array<BodyPoint, 2>& sides)
{
    Link link;
    link.sides = sides;
    link.frame = kWorldAxes;
    const Vec3 gap = sides[0].position - sides[1].position;
    if (isHard(attachment)) {
        link.bias = recovery(gap, dt);
        link.impulse = dt * carried;
        link.slack = kSlack / dt;
    } else {
        link.give = dt * dt * attachment.stiffness;
        link.bias = 1.0 / dt * gap;
    }
    return link;
}

/// Where a hard pair's next solve starts, [N s]: what the solve says, less what its recovery has added in vain. A pair
/// that others hold apart would pull at them more and more, and fly off when they let go.
Vec3 carriedOn(const Link& link, double dt, Vec3 carried, Vec3 gapAfter)
{
    const double speed = length(link.bias);
    const Vec3 before = link.sides[0].position - link.sides[1].position, u = 1.0 / dt * (gapAfter - before);
    const double missed = length(link.bias + u);
    if (speed > 0.999 * kRecoverySpeed) return {};
    if (speed == 0.0 || missed == 0.0) return link.next;
    const double obeyed = std::clamp(-dot(u, link.bias) / (kInVain * speed * speed), 0.0, 1.0);
    const double stiffness = length(link.next - dt * carried) / missed;
    return link.next + (1.0 - obeyed) * stiffness * link.bias;
}

void keep(std::size_t attachment, double dt, std::span<const Link> links, const Places& places, const Model& model,
          State& state)
{
    const Attachment& made = state.attachments[attachment];
    const auto body = findBody(model, made.body), to = findBody(model, made.to);
    frame::Attachment report{.id = made.id, .body = made.body, .to = made.to};
    report.points = static_cast<int>(made.pairs.size());
    for (std::size_t p = 0; p < links.size(); ++p) {
        const Vec3 force = 1.0 / dt * links[p].impulse;
        if (isFinite(force)) report.force += force;
        Vec3& carried = state.holding[attachment][p];
        const Vec3 gap = places.of(made.pairs[p][0], body).position - places.of(made.pairs[p][1], to).position;
        const Vec3 next = isHard(made) ? 1.0 / dt * carriedOn(links[p], dt, carried, gap) : Vec3{};
        carried = isFinite(next) ? next : Vec3{};
    }
    report.broken = length(report.force) > made.breakForce;
    state.held.push_back(report);
}

template <class Gone> void eraseAttachments(State& state, const Gone& gone)
{
    for (std::size_t a = state.attachments.size(); a-- > 0;) {
        if (!gone(state.attachments[a])) continue;
        state.attachments.erase(state.attachments.begin() + static_cast<std::ptrdiff_t>(a));
        state.holding.erase(state.holding.begin() + static_cast<std::ptrdiff_t>(a));
    }
}

template <class Def> void attachAny(AttachmentId id, BodyId body, const Def& def, const std::string& nothing,
                                    const Model& model, State& state, physics::StepReport& report)
{
    AttachedPairs pairs = pairsOf(def, findBody(model, body)->index, model, state);
    if (pairs.empty()) {
        report.set(physics::StepFlag::NothingAttached);
        logWarning(nameOf(model, body), ": attachment.", nothing, ": no node is there; nothing is held");
        return;
    }
    std::vector<Vec3> forces(pairs.size());
    addAttachment({id, body, def.to, std::move(pairs), def.stiffness, def.breakForce}, std::move(forces), state);
}

} // namespace

void attach(AttachmentId id, BodyId body, const physics::AttachmentDef& def, const Model& model, State& state,
            physics::StepReport& report)
{
    attachAny(id, body, def, regionsOf(def), model, state, report);
}

void attach(AttachmentId id, BodyId body, const physics::RigidAttachmentDef& def, const Model& model, State& state,
            physics::StepReport& report)
{
    attachAny(id, body, def, {}, model, state, report);
}

void addAttachment(Attachment attachment, std::vector<Vec3> forces, State& state)
{
    const auto place = std::upper_bound(state.attachments.begin(), state.attachments.end(), attachment.id,
                                        [](AttachmentId id, const Attachment& other) { return id < other.id; });
    state.holding.insert(state.holding.begin() + (place - state.attachments.begin()), std::move(forces));
    state.attachments.insert(place, std::move(attachment));
}

void release(AttachmentId id, State& state)
{
    eraseAttachments(state, [&](const Attachment& each) { return each.id == id; });
    std::erase_if(state.grasps, [&](const PendingGrasp& each) { return each.id == id; });
    std::erase_if(state.held, [&](const frame::Attachment& each) { return each.id == id; });
}

void removeAttachmentsOf(BodyId id, State& state)
{
    eraseAttachments(state, [&](const Attachment& each) { return each.body == id || each.to == id; });
    std::erase_if(state.grasps, [&](const PendingGrasp& each) { return each.rigid == id || each.target == id; });
    std::erase_if(state.held, [&](const frame::Attachment& each) { return each.body == id || each.to == id; });
}

void linkAttachments(double dt, const Model& model, State& state, Coupling& coupling, physics::StepReport& report)
{
    if (dt == 0.0) return;
    graspContacts(model, state, coupling, report);
    if (state.attachments.empty()) return;
    leaveToAttachments(state, coupling);
    const Places places(model, state, coupling.rigid);
    for (std::size_t a = 0; a < state.attachments.size(); ++a) {
        const Attachment& attachment = state.attachments[a];
        const auto body = findBody(model, attachment.body), to = findBody(model, attachment.to);
        for (std::size_t p = 0; p < attachment.pairs.size(); ++p) {
            const auto& pair = attachment.pairs[p];
            coupling.links.push_back(
                linkOf(attachment, dt, state.holding[a][p], {places.of(pair[0], body), places.of(pair[1], to)}));
        }
    }
}

void keepAttachments(double dt, const Coupling& coupling, const Systems& systems, const Model& model, State& state)
{
    if (dt == 0.0) { // what broke is told once
        std::erase_if(state.held, [](const frame::Attachment& each) { return each.broken; });
        return;
    }
    state.held.clear();
    std::span<const Link> links = std::span(coupling.links).subspan(coupling.contacts.size());
    std::vector<AttachmentId> broken;
    const Places places(model, state, coupling.rigid);
    for (std::size_t a = 0; a < state.attachments.size(); ++a) {
        const std::size_t count = state.attachments[a].pairs.size();
        keep(a, dt, links.first(count), places, model, state);
        links = links.subspan(count);
        if (state.held.back().broken) broken.push_back(state.held.back().id);
    }
    addPinReports(model, dt, coupling, state, systems, state.held);
    std::ranges::stable_sort(state.held, {}, &frame::Attachment::id);
    eraseAttachments(state, [&](const Attachment& each) { return std::ranges::count(broken, each.id) > 0; });
}

} // namespace filasofia::engine
