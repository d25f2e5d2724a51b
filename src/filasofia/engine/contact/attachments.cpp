#include "filasofia/engine/contact/attachments.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/engine/contact/attached_contacts.h"
#include "filasofia/engine/contact/attachment_points.h"
#include "filasofia/engine/contact/pin_reactions.h"
#include "filasofia/engine/contact/turning_attachments.h"
#include "filasofia/engine/scene/find_body.h"
#include "filasofia/physics/attachment_break.h"

#include <algorithm>
#include <type_traits>
#include <utility>

namespace filasofia::engine {
namespace {

// Points that have drifted apart approach by this fraction of the gap per step, at kAttachmentSpeed at most. At that
// speed they are still pulled, but the impulse is not carried to the next step: if they cannot come together, it would
// grow without bound.
constexpr double kAttachmentRecovery = 0.1;
constexpr double kAttachmentSpeed = 1.0; ///< [m/s]
/// [m] how far a hard pair may move apart in a step before its multiplier is updated
constexpr double kAttachmentTolerance = 1e-5;
/// [rad] how far a rod may turn against its holder in a step before the multiplier is updated
constexpr double kTurnTolerance = 1e-4;
constexpr double kFailedRecovery = 0.05; ///< a recovery below this fraction of the requested one counts as failed

constexpr std::array<Vec3, 3> kWorldAxes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};

bool isHard(const Attachment& attachment) { return attachment.stiffness == physics::kHard; }

/// The names of the region fields that a Def sets.
std::string regionsOf(const physics::AttachmentDef& def)
{
    std::string names;
    for (const auto& [name, given] :
         {std::pair{"box", def.box.has_value()}, {"ball", def.ball.has_value()}, {"within", def.within.has_value()}})
        if (given) names += text(names.empty() ? "" : ", ", name);
    if (names.empty() && !def.toNodes.empty()) return "toNodes";
    return names.empty() ? "to" : names;
}

Vec3 positionOf(const AttachedPoint& point, const std::optional<BodyPlace>& body, const Scene& scene)
{
    if (!body) return point.place;
    if (!body->soft)
        return transform(scene.rigid[body->index].state.poses[static_cast<std::size_t>(point.element)], point.place);
    return meanOf(point.nodes, scene.soft[body->index].state.x);
}

/// The current positions of attached points, and their velocities in a step of dt [s].
class Places {
public:
    Places(double dt, const Scene& scene, const RigidPlan& plan)
        : dt_(dt), scene_(scene), plan_(plan), firstElement_(firstElements(scene))
    {
    }

    [[nodiscard]] Vec3 positionOf(const AttachedPoint& point, const std::optional<BodyPlace>& body) const
    {
        return engine::positionOf(point, body, scene_);
    }

    /// `out` is a BodyPoint that nothing was written to.
    void write(const AttachedPoint& point, const std::optional<BodyPlace>& body, BodyPoint& out) const
    {
        if (body && body->soft) return writeSoftPoint(point.nodes, body->index, scene_.soft[body->index].state, out);
        out.position = positionOf(point, body);
        if (!body) return;
        out.of = BodyPoint::Of::Rigid;
        out.body = firstElement_[body->index] + static_cast<std::size_t>(point.element);
        foreseeArc(dt_, plan_[out.body], out);
    }

    /// An edge of a rod and the rigid body that it turns with. The angle is by how much the edge is ahead.
    [[nodiscard]] std::array<BodyPoint, 2> of(const AttachedTurn& turn, std::size_t rod, std::size_t rigid) const
    {
        const SoftState& state = scene_.soft[rod].state;
        const auto edge = static_cast<std::size_t>(turn.edge), element = static_cast<std::size_t>(turn.element);
        const double radius = scene_.soft[rod].model.rod.radius;
        const Vec3 along = normalized(state.x[wrapped(edge + 1, state.x.size())] - state.x[edge], {1.0, 0.0, 0.0});
        const Vec3 carried = rotate(scene_.rigid[rigid].state.poses[element].orientation, turn.director);
        const Vec3 director = state.rod.directors[edge];
        BodyPoint one, two;
        one.of = BodyPoint::Of::RodEdge;
        one.body = rod;
        one.edge = turn.edge;
        one.position.x = radius * std::atan2(dot(cross(carried, director), along),
                                             dot(carried, director) - dot(carried, along) * dot(director, along));
        one.velocity.x = radius * state.rod.spins[edge];
        two.of = BodyPoint::Of::Turning;
        two.body = firstElement_[rigid] + element;
        two.velocity.x = radius * dot(plan_[two.body].angularVelocity, along);
        one.axis = two.axis = radius * along;
        return {one, two};
    }

    /// Appends a weld for each part of an attachment: its pairs, then its turns. Only their sides are written.
    void addWelds(const Attachment& attachment, std::vector<Constraint>& welds) const
    {
        const auto body = findBody(scene_, attachment.body), to = findBody(scene_, attachment.to);
        for (const auto& pair : attachment.pairs) {
            std::array<BodyPoint, 2>& sides = welds.emplace_back().sides;
            write(pair[0], body, sides[0]);
            write(pair[1], to, sides[1]);
        }
        for (const AttachedTurn& turn : attachment.turns) welds.emplace_back().sides = of(turn, body->index, to->index);
    }

    /// How far the sides of each part are apart now.
    [[nodiscard]] std::vector<Vec3> gapsOf(const Attachment& attachment) const
    {
        std::vector<Vec3> gaps;
        const auto body = findBody(scene_, attachment.body), to = findBody(scene_, attachment.to);
        for (const auto& pair : attachment.pairs) gaps.push_back(positionOf(pair[0], body) - positionOf(pair[1], to));
        for (const AttachedTurn& turn : attachment.turns) {
            const auto [one, two] = of(turn, body->index, to->index);
            gaps.push_back(one.position - two.position);
        }
        return gaps;
    }

private:
    double dt_;
    const Scene& scene_;
    const RigidPlan& plan_;
    std::vector<std::size_t> firstElement_;
};

/// The speed [m/s] at which a hard pair closes its gap.
Vec3 recovery(Vec3 gap, double dt)
{
    const Vec3 bias = kAttachmentRecovery / dt * gap;
    const double speed = length(bias);
    return speed > kAttachmentSpeed ? kAttachmentSpeed / speed * bias : bias;
}

/// Completes a weld whose sides are there.
void finishWeld(const Attachment& attachment, double dt, Vec3 carried, Constraint& weld)
{
    weld.kind = ConstraintKind::Weld;
    weld.frame = kWorldAxes;
    const Vec3 gap = weld.sides[0].position - weld.sides[1].position;
    if (isHard(attachment)) {
        weld.bias = recovery(gap, dt);
        weld.impulse = dt * carried;
        const bool turning = weld.sides[0].of == BodyPoint::Of::RodEdge;
        weld.tolerance = (turning ? kTurnTolerance * length(weld.sides[0].axis) : kAttachmentTolerance) / dt;
    } else {
        weld.softness = dt * dt * attachment.stiffness;
        weld.bias = 1.0 / dt * gap;
    }
}

/// [N s] The start of a hard pair's next solve: the multiplier, less what a failed recovery has added to it. Otherwise
/// a pair that others keep apart would pull harder and harder, and fly off when they let go.
Vec3 nextStart(const Constraint& weld, double dt, Vec3 carried, Vec3 gapAfter)
{
    const double speed = length(weld.bias);
    const Vec3 before = weld.sides[0].position - weld.sides[1].position, u = 1.0 / dt * (gapAfter - before);
    const double missed = length(weld.bias + u);
    if (speed > 0.999 * kAttachmentSpeed) return {};
    if (speed == 0.0 || missed == 0.0) return weld.multiplier;
    const double recovered = std::clamp(-dot(u, weld.bias) / (kFailedRecovery * speed * speed), 0.0, 1.0);
    const double stiffness = length(weld.multiplier - dt * carried) / missed;
    return weld.multiplier + (1.0 - recovered) * stiffness * weld.bias;
}

/// Removes the pairs whose force exceeded what a point bears; returns their number.
int letGo(std::size_t attachment, double dt, std::span<const Constraint> welds, Scene& scene)
{
    Attachment& made = scene.attachments[attachment];
    made.parted = 0;
    if (made.pointBreakForce == physics::kNever) return 0;
    std::vector<bool> gone;
    for (std::size_t p = 0; p < made.pairs.size(); ++p)
        gone.push_back(length(welds[p].impulse) > dt * made.pointBreakForce);
    return erasePairs(attachment, gone, scene);
}

void keep(std::size_t attachment, double dt, std::span<const Constraint> welds, const Places& places, Scene& scene)
{
    const Attachment& made = scene.attachments[attachment];
    const std::vector<Vec3> after = isHard(made) ? places.gapsOf(made) : std::vector<Vec3>{};
    frame::Attachment report{.id = made.id, .body = made.body, .to = made.to};
    report.points = static_cast<int>(made.pairs.size());
    report.parted = made.parted;
    for (std::size_t p = 0; p < welds.size(); ++p) {
        const Vec3 force = 1.0 / dt * welds[p].impulse;
        if (!isFinite(force))
            ;
        else if (p < made.pairs.size())
            report.force += force;
        else
            report.torque += force.x * welds[p].sides[0].axis;
        Vec3& carried = scene.attachmentForces[attachment][p];
        const Vec3 next = isHard(made) ? 1.0 / dt * nextStart(welds[p], dt, carried, after[p]) : Vec3{};
        carried = isFinite(next) ? next : Vec3{};
    }
    report.parted += letGo(attachment, dt, welds, scene);
    report.broken = length(report.force) > made.breakForce || made.pairs.empty();
    scene.attachmentReports.push_back(report);
}

template <class Gone> void eraseAttachments(Scene& scene, const Gone& gone)
{
    for (std::size_t a = scene.attachments.size(); a-- > 0;) {
        if (!gone(scene.attachments[a])) continue;
        scene.attachments.erase(scene.attachments.begin() + static_cast<std::ptrdiff_t>(a));
        scene.attachmentForces.erase(scene.attachmentForces.begin() + static_cast<std::ptrdiff_t>(a));
    }
}

/// The edges of a rod whose two nodes are attached to a rigid body.
std::vector<AttachedTurn> turnsOf(const Attachment& attachment, const Scene& scene)
{
    const auto body = findBody(scene, attachment.body), to = findBody(scene, attachment.to);
    if (!body->soft || !to || to->soft || !isRod(scene.soft[body->index].model)) return {};
    const RodState& rod = scene.soft[body->index].state.rod;
    std::vector<int> elements(scene.soft[body->index].model.rest.size(), -1); // per node: the element that holds it
    for (const auto& pair : attachment.pairs)
        for (const NodeWeight& each : pair[0].nodes) elements[static_cast<std::size_t>(each.node)] = pair[1].element;
    std::vector<AttachedTurn> turns;
    for (std::size_t e = 0; e < rod.directors.size(); ++e) {
        if (isCut(scene.soft[body->index].model.rod, e)) continue;
        if (elements[e] < 0 || elements[e] != elements[wrapped(e + 1, elements.size())]) continue;
        const auto element = static_cast<std::size_t>(elements[e]);
        const Quat orientation = scene.rigid[to->index].state.poses[element].orientation;
        turns.push_back({static_cast<int>(e), elements[e], rotate(conjugate(orientation), rod.directors[e])});
    }
    return turns;
}

/// `nothing`: the names of the fields whose regions hold no node.
template <class Def> void attachAny(const AttachmentName& name, const Def& def, const std::string& nothing,
                                    Scene& scene, physics::StepReport& report)
{
    AttachedPairs pairs = pairsOf(def, findBody(scene, name.body)->index, scene);
    if (pairs.empty()) {
        report.set(physics::StepFlag::NothingAttached);
        report.nothingHeld.push_back({.id = name.id, .body = name.body, .to = def.to});
        logWarning(nameOf(scene, name.body), ": attachment.", nothing, ": no node is there; nothing is attached",
                   def.to ? " to " + nameOf(scene, def.to) : std::string());
        return;
    }
    Attachment made{name.id, name.body, def.to, std::move(pairs), {}, def.stiffness, def.breakForce};
    if constexpr (std::is_same_v<Def, physics::AttachmentDef>) {
        made.pointBreakForce = def.pointBreakForce;
        made.cutDistance = def.cutDistance;
        if (def.pointBreakForce != physics::kNever || def.cutDistance > 0.0)
            made.whole = std::make_shared<const AttachedPairs>(made.pairs);
    }
    addAttachment(std::move(made), {}, scene);
}

} // namespace

std::string nameOf(const Scene& scene, BodyId id)
{
    const auto place = findBody(scene, id);
    if (!place) return text("body ", id.value);
    if (place->soft) return describe(scene.soft[place->index].model);
    return text("rigid body '", scene.rigid[place->index].model.name, "'");
}

void attach(const AttachmentName& name, const physics::AttachmentDef& def, Scene& scene, physics::StepReport& report)
{
    attachAny(name, def, regionsOf(def), scene, report);
}

void attach(const AttachmentName& name, const physics::RigidAttachmentDef& def, Scene& scene,
            physics::StepReport& report)
{
    attachAny(name, def, {}, scene, report);
}

void addAttachment(Attachment attachment, std::vector<Vec3> forces, Scene& scene)
{
    attachment.turns = turnsOf(attachment, scene);
    forces.resize(attachment.pairs.size() + attachment.turns.size());
    const auto place = std::upper_bound(scene.attachments.begin(), scene.attachments.end(), attachment.id,
                                        [](AttachmentId id, const Attachment& other) { return id < other.id; });
    scene.attachmentForces.insert(scene.attachmentForces.begin() + (place - scene.attachments.begin()),
                                  std::move(forces));
    scene.attachments.insert(place, std::move(attachment));
}

int erasePairs(std::size_t attachment, const std::vector<bool>& gone, Scene& scene)
{
    Attachment& made = scene.attachments[attachment];
    std::vector<Vec3>& forces = scene.attachmentForces[attachment];
    std::size_t kept = 0;
    for (std::size_t p = 0; p < forces.size(); ++p) {
        if (p < gone.size() && gone[p]) continue;
        if (p < made.pairs.size() && kept != p) made.pairs[kept] = std::move(made.pairs[p]);
        forces[kept++] = forces[p];
    }
    const std::size_t erased = forces.size() - kept;
    forces.resize(kept);
    made.pairs.resize(made.pairs.size() - erased);
    return static_cast<int>(erased);
}

void findHeldEdges(Scene& scene)
{
    for (SoftBody& body : scene.soft) {
        if (!isRod(body.model)) continue;
        std::vector<bool> held;
        for (const Attachment& each : scene.attachments) {
            if (each.body != body.model.id || !isHard(each)) continue;
            held.resize(body.model.rod.edges.size());
            for (const AttachedTurn& turn : each.turns) held[static_cast<std::size_t>(turn.edge)] = true;
        }
        if (held == body.model.rod.held) continue;
        body.model.rod.held = std::move(held);
        outdate(body.system.tuned, body.system);
    }
}

void release(AttachmentId id, Scene& scene)
{
    eraseAttachments(scene, [&](const Attachment& each) { return each.id == id; });
    std::erase_if(scene.grasps, [&](const PendingGrasp& each) { return each.id == id; });
    std::erase_if(scene.attachmentReports, [&](const frame::Attachment& each) { return each.id == id; });
}

void removeAttachmentsOf(BodyId id, Scene& scene)
{
    eraseAttachments(scene, [&](const Attachment& each) { return each.body == id || each.to == id; });
    std::erase_if(scene.grasps, [&](const PendingGrasp& each) { return each.rigid == id || each.target == id; });
    std::erase_if(scene.attachmentReports,
                  [&](const frame::Attachment& each) { return each.body == id || each.to == id; });
}

void addWelds(const StepContext& context, Scene& scene, Coupling& coupling)
{
    const double dt = context.dt;
    if (dt == 0.0) return;
    graspContacts(coupling, scene, context.report);
    if (scene.attachments.empty()) return;
    leaveToAttachments(scene, coupling);
    const Places places(dt, scene, coupling.rigid);
    for (std::size_t a = 0; a < scene.attachments.size(); ++a) {
        const std::size_t first = coupling.constraints.size();
        places.addWelds(scene.attachments[a], coupling.constraints);
        for (std::size_t p = 0; first + p < coupling.constraints.size(); ++p) {
            Constraint& weld = coupling.constraints[first + p];
            finishWeld(scene.attachments[a], dt, scene.attachmentForces[a][p], weld);
            if (isHard(scene.attachments[a]) && scene.attachments[a].pairs.size() == 1)
                addHeldInertia(dt, weld, coupling.rigid);
        }
    }
    coupling.weldCount = coupling.constraints.size() - coupling.contactCount;
}

void placePoints(const Scene& scene, std::vector<frame::AttachedPoint>& out)
{
    out.clear();
    for (const Attachment& each : scene.attachments) {
        if (!each.whole) continue;
        const auto body = findBody(scene, each.body), to = findBody(scene, each.to);
        for (const auto& [mine, other] : each.pairs)
            out.push_back({each.id, mine.nodes.empty() ? 0 : mine.nodes.front().node, positionOf(mine, body, scene),
                           positionOf(other, to, scene)});
    }
}

void keepWelds(const StepContext& context, const Coupling& coupling, Scene& scene)
{
    const double dt = context.dt;
    if (dt == 0.0) { // a break is reported once
        std::erase_if(scene.attachmentReports, [](const frame::Attachment& each) { return each.broken; });
        return;
    }
    scene.attachmentReports.clear();
    std::span<const Constraint> welds = coupling.welds();
    std::vector<AttachmentId> broken;
    const Places places(dt, scene, coupling.rigid);
    for (std::size_t a = 0; a < scene.attachments.size(); ++a) {
        const std::size_t count = scene.attachmentForces[a].size();
        keep(a, dt, welds.first(count), places, scene);
        welds = welds.subspan(count);
        const frame::Attachment& report = scene.attachmentReports.back();
        if (report.broken) broken.push_back(report.id);
        const Attachment& made = scene.attachments[a];
        if (const auto gone = physics::breakOf(report, static_cast<int>(made.pairs.size()), made.grasp))
            context.report.breaks.push_back(*gone);
    }
    addPinReactions(context, coupling.constraints, scene);
    std::ranges::stable_sort(scene.attachmentReports, {}, &frame::Attachment::id);
    eraseAttachments(scene, [&](const Attachment& each) { return std::ranges::count(broken, each.id) > 0; });
}

} // namespace filasofia::engine
