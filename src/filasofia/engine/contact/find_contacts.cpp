#include "filasofia/core/log.h"
#include "filasofia/engine/collision/deep_points.h"
#include "filasofia/engine/contact/warm_start.h"
#include "filasofia/engine/contact/islands.h"
#include "filasofia/engine/step/stages.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace filasofia::engine {
namespace {

// Surfaces that are inside each other part at this share of their depth per step, and not faster than that: pushed out
// at once they would fly apart. Within the skin they take their time: impulses that are carried from step to step
// and grow with a gap are an oscillator, stable only where the penalty is more than this share of what it moves.
constexpr double kRecovery = 0.2, kShallowRecovery = 0.05;
constexpr double kRecoverySpeed = 0.1; ///< [m/s]
// Where rigid bodies are told to go there may be no place for one between them: what is carried would then grow without
// end. It loses this share per step, more where they are deeper inside each other than at rest. A body sinks in by
// micrometres for it: its penalty bears 99 % of its weight.
constexpr double kRigidLoss = 0.02, kDeepRigidLoss = 0.2;

/// What a surface belongs to.
struct Owner {
    bool soft = true;
    std::size_t body = 0; ///< among its kind
    std::size_t plan = 0; ///< of a rigid one: its element's place in the plan
    SurfaceName name;
    const CollisionModel* collision = nullptr;
};

std::vector<Owner> ownersOf(const Model& model)
{
    std::vector<Owner> owners;
    const auto add = [&](bool soft, std::size_t b, const auto& body, std::size_t firstElement) {
        for (int m = 0; const CollisionModel& each : body.collision) {
            const SurfaceName name{body.id, m++};
            if (soft && each.shape->cutting) continue; // that one is for blades
            owners.push_back({soft, b, firstElement + static_cast<std::size_t>(each.element), name, &each});
        }
    };
    for (std::size_t b = 0; b < model.softBodies.size(); ++b) add(true, b, model.softBodies[b], 0);
    const std::vector<std::size_t> first = firstElements(model);
    for (std::size_t b = 0; b < model.rigidBodies.size(); ++b) add(false, b, model.rigidBodies[b], first[b]);
    return owners;
}

Vec3 mean(const std::vector<Vec3>& values, const geometry::Tetrahedron& nodes, const std::array<double, 4>& weights)
{
    Vec3 sum;
    for (std::size_t k = 0; k < 4; ++k)
        if (weights[k] != 0.0) sum += weights[k] * values[static_cast<std::size_t>(nodes[k])];
    return sum;
}

void placeSurface(const Owner& owner, const State& state, const RigidPlan& plan, std::vector<Vec3>& normals,
                  CollisionSurface& out)
{
    const CollisionModel& collision = *owner.collision;
    const std::size_t count = collision.shape->rest.size();
    out.shape = collision.shape;
    out.x.resize(count);
    out.v.resize(count);
    if (owner.soft) {
        const SoftState& body = state.softBodies[owner.body];
        for (std::size_t i = 0; i < count; ++i) {
            out.x[i] = mean(body.x, collision.ties.nodes[i], collision.ties.weights[i]);
            out.v[i] = mean(body.v, collision.ties.nodes[i], collision.ties.weights[i]);
        }
        applyInset(*collision.shape, collision.inset, normals, out.x);
        return;
    }
    const RigidPlanElement& element = plan[owner.plan];
    const Pose& pose = state.rigidBodies[owner.body].poses[element.element];
    const Mat3 turn = toMat3(pose.orientation);
    const Vec3 velocity = element.velocity + element.change.linear,
               spin = element.angularVelocity + element.change.angular;
    for (std::size_t i = 0; i < count; ++i) {
        out.x[i] = pose.position + turn * collision.core[i];
        out.v[i] = velocity + cross(spin, out.x[i] - element.centre);
    }
}

/// [m] what was taken off a surface where something is near it.
double insetAt(const CollisionModel& collision, const Proximity& found, std::size_t side)
{
    double depth = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
        if (const int vertex = found.vertices[side][k]; vertex >= 0)
            depth += found.weights[side][k] * collision.inset.depth[static_cast<std::size_t>(vertex)];
    return depth;
}

/// [m] by how much the two come nearer to each other in the time that is looked ahead.
double comingNearer(const std::vector<CollisionSurface>& surfaces, const Proximity& found, double dt)
{
    Vec3 velocity;
    for (std::size_t side = 0; side < 2; ++side)
        for (std::size_t k = 0; k < 3; ++k)
            if (const int vertex = found.vertices[side][k]; vertex >= 0)
                velocity +=
                    (side == 0 ? 1.0 : -1.0) * found.weights[side][k] *
                    surfaces[static_cast<std::size_t>(found.surfaces[side])].v[static_cast<std::size_t>(vertex)];
    return kStepsAhead * dt * std::max(0.0, -dot(velocity, found.normal));
}

/// Whether a place lies on an element of a soft body that is turned inside out: there its surface looks the wrong way,
/// and would hold it there.
bool insideOut(const Owner& owner, const Proximity& found, std::size_t side, const State& state)
{
    const CollisionModel& collision = *owner.collision;
    if (!owner.soft || collision.behind.empty()) return false;
    const std::vector<Vec3>& x = state.softBodies[owner.body].x;
    const auto node = [&](int vertex) { return collision.ties.nodes[static_cast<std::size_t>(vertex)][0]; };
    for (int vertex : found.vertices[side]) {
        if (vertex < 0) continue;
        for (int triangle : collision.shape->vertexTriangles[vertex]) {
            const auto [a, b, c] = collision.shape->triangles[static_cast<std::size_t>(triangle)];
            const int d = collision.behind[static_cast<std::size_t>(triangle)];
            if (geometry::signedVolume(x[node(a)], x[node(b)], x[node(c)], x[d]) >= 0.0)
                return true; // it looks inwards
        }
    }
    return false;
}

/// Whether the other side knows by itself which way a point of tissue is to go: rigid triangles do, however the tissue
/// around the point is turned. Without, tissue that is crushed against them would go through.
bool rigidTells(const Owner& other, const Proximity& found, std::size_t side)
{
    return !other.soft && other.collision->shape->triangleFaces && found.vertices[side][1] < 0 &&
           found.vertices[1 - side][1] >= 0;
}

BodyPoint pointOf(const Owner& owner, const Proximity& found, std::size_t side, const CollisionSurface& surface,
                  const State& state, const RigidPlan& plan)
{
    BodyPoint point;
    point.of = owner.soft ? BodyPoint::Of::Soft : BodyPoint::Of::Rigid;
    point.body = owner.soft ? owner.body : owner.plan;
    for (std::size_t k = 0; k < 3; ++k) {
        const double weight = found.weights[side][k];
        if (found.vertices[side][k] < 0 || weight == 0.0) continue;
        const auto vertex = static_cast<std::size_t>(found.vertices[side][k]);
        point.position += weight * surface.x[vertex];
        if (!owner.soft) continue;
        const geometry::Embedding& ties = owner.collision->ties;
        for (std::size_t n = 0; n < 4; ++n) point.add(ties.nodes[vertex][n], weight * ties.weights[vertex][n]);
    }
    if (owner.soft) {
        const std::vector<Vec3>& v = state.softBodies[owner.body].v;
        for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k)
            point.velocity += point.weights[k] * v[static_cast<std::size_t>(point.nodes[k])];
    } else {
        const RigidPlanElement& element = plan[owner.plan];
        point.velocity = element.velocity + cross(element.angularVelocity, point.position - element.centre);
    }
    return point;
}

// The gap that contacts hold, of both proximities. Surfaces that rest on each other stay apart by so little, where it
// is plain which side is out: were it 0, half of them would be inside.
constexpr double kSkin = 0.01;

constexpr double kSlack = 1e-6;     ///< [m] that a surface may go too far in a step, whatever its proximity
constexpr double kSoftSlack = 0.02; ///< of the proximity: tissue may go so much farther and come back in the next step

/// The law of a contact with a gap.
void setLaw(const physics::ContactMethod& method, double dt, const FoundContact& contact, Link& link)
{
    const double gap = contact.gap - contact.skin;
    if (const auto* penalty = std::get_if<physics::PenaltyContact>(&method)) {
        link.give = dt * (dt * penalty->stiffness + penalty->damping);
        // What is apart is pushed only by the part of its way that leads inside, its damper included.
        link.bias = {gap > 0.0 ? gap / dt : dt * penalty->stiffness * gap / link.give, 0.0, 0.0};
        return;
    }
    link.impulse = dt * inFrame(link.frame, contact.memory.force);
    const auto isSoft = [](const BodyPoint& point) { return point.of == BodyPoint::Of::Soft; };
    const bool anySoft = std::ranges::any_of(link.sides, isSoft);
    const double loss = anySoft ? 0.0 : gap < -contact.skin ? kDeepRigidLoss : kRigidLoss;
    link.impulse.x = std::max(0.0, (1.0 - loss) * link.impulse.x);
    // What pushed last time may rest within the skin; all else may come as near as that.
    const double resting = link.impulse.x > 0.0 ? contact.skin : 0.0;
    const double shallow = std::clamp(gap, -contact.skin, resting), deep = std::min(0.0, gap + contact.skin);
    const double back = std::max(kShallowRecovery * shallow + kRecovery * deep, -kRecoverySpeed * dt);
    link.bias.x = (back + std::max(0.0, gap - resting)) / dt;
    const double soft = anySoft ? kSoftSlack * contact.proximity : 0.0;
    link.slack = std::max({kShallowRecovery * contact.skin, contact.gap - dt * link.bias.x, soft, kSlack}) / dt;
}

double frictionOf(const Model& model, const Owner& owner)
{
    return owner.soft ? model.softBodies[owner.body].friction : model.rigidBodies[owner.body].friction;
}

const std::string& nameOf(const Model& model, const Owner& owner)
{
    return owner.soft ? model.softBodies[owner.body].name : model.rigidBodies[owner.body].name;
}

/// A group that is one body's alone is hardly meant: a word, once for each group.
void warnOfLoneGroups(const Model& model, const std::vector<Owner>& owners, std::set<int>& warned)
{
    for (const Owner& owner : owners) {
        const CollisionShape& shape = *owner.collision->shape;
        const auto isOther = [&](const Owner& each) { return each.soft != owner.soft || each.body != owner.body; };
        const auto meets = [&](const Owner& each) {
            return isOther(each) && each.collision->shape->group == shape.group;
        };
        if (shape.self || std::ranges::none_of(owners, isOther) || std::ranges::any_of(owners, meets)) continue;
        if (!warned.insert(shape.group).second) continue;
        logWarning(owner.soft ? "soft" : "rigid", " body '", nameOf(model, owner),
                   "': no other body has collision group ", shape.group, ": it touches nothing");
    }
}

/// Where surfaces rest on each other only their insets, a share of the proximities, tell in from out: a word, once for
/// each group, where both together are hardly more than what rounding and a step's way may be.
void warnOfThinProximity(const Model& model, const std::vector<Owner>& owners, std::set<int>& warned)
{
    constexpr double thin = 1e-4; // [m]
    for (const Owner& a : owners) {
        if (a.collision->proximity >= thin) continue; // nearly all: or a thousand bodies were a million pairs
        for (const Owner& b : owners) {
            const CollisionShape &one = *a.collision->shape, &two = *b.collision->shape;
            const double both = a.collision->proximity + b.collision->proximity;
            if (!(a.name.body < b.name.body) || one.group != two.group || one.cutting || two.cutting || both >= thin)
                continue;
            if (warned.insert(one.group).second)
                logWarning("body '", nameOf(model, a), "' and body '", nameOf(model, b), "': the proximities of their ",
                           "collision models add up to ", both, " m: below ", thin, " m contacts may be missed");
        }
    }
}

bool movable(const Owner& owner, const RigidPlan& plan) { return owner.soft || plan[owner.plan].dynamic; }

bool movable(const BodyPoint& point, const RigidPlan& plan)
{
    return (point.of == BodyPoint::Of::Soft && point.count > 0) || planPlace(plan, point).has_value();
}

/// Points of either surface that are in the other one deeper than contacts are followed. A rigid one tells its way out
/// at any depth, tissue does not: in tissue they are only counted.
struct DeepPoints {
    std::vector<Proximity> inRigid, inTissue;
};
DeepPoints deepPointsOf(const std::vector<Owner>& owners, const Coupling& coupling, std::array<int, 2> pair)
{
    const auto i = static_cast<std::size_t>(pair[0]), k = static_cast<std::size_t>(pair[1]);
    const Meeting meeting{{&coupling.surfaces[i], &coupling.surfaces[k]}, pair, 0.0};
    DeepPoints deep;
    findDeepPoints(meeting, 0, owners[k].soft ? deep.inTissue : deep.inRigid);
    findDeepPoints(meeting, 1, owners[i].soft ? deep.inTissue : deep.inRigid);
    return deep;
}

/// A body that starts inside another, deeper than contacts are followed: a word, and from then on the pair is looked at
/// at any depth. `added`: of each surface.
void noteStartsInside(const Model& model, const std::vector<Owner>& owners, const std::vector<bool>& added,
                      Coupling& coupling)
{
    for (const std::array<int, 2>& pair : coupling.proximityScratch.surfacePairs) {
        const auto i = static_cast<std::size_t>(pair[0]), k = static_cast<std::size_t>(pair[1]);
        const Owner &one = owners[i], &two = owners[k];
        if (i == k || !(added[i] || added[k])) continue;
        if (!movable(one, coupling.rigid) && !movable(two, coupling.rigid)) continue;
        const DeepPoints deep = deepPointsOf(owners, coupling, pair);
        if (deep.inRigid.empty() && deep.inTissue.empty()) continue;
        coupling.startedInside.push_back({one.name, two.name});
        logWarning("body '", nameOf(model, one), "' and body '", nameOf(model, two), "' start inside each other: ",
                   deep.inRigid.empty() ? "what is in tissue stays there" : "they are pushed apart");
    }
}

void addDeepPoints(const std::vector<Owner>& owners, Coupling& coupling)
{
    if (coupling.startedInside.empty()) return;
    for (const std::array<int, 2>& pair : coupling.proximityScratch.surfacePairs) {
        const std::array names{owners[static_cast<std::size_t>(pair[0])].name,
                               owners[static_cast<std::size_t>(pair[1])].name};
        if (std::ranges::find(coupling.startedInside, names) == coupling.startedInside.end()) continue;
        const DeepPoints deep = deepPointsOf(owners, coupling, pair);
        coupling.proximities.insert(coupling.proximities.end(), deep.inRigid.begin(), deep.inRigid.end());
    }
}

} // namespace

void findContacts(const Model& model, double dt, const physics::ContactMethod& method, const State& state,
                  Coupling& coupling, WorkerPool& pool)
{
    planRigid(model, dt, state.gravity, state, coupling.rigid);
    planArticulations(model, dt, state.gravity, state, coupling.rigid, coupling.articulations);
    coupling.links.clear();
    coupling.contacts.clear();
    if (dt == 0.0) return;

    const std::vector<Owner> owners = ownersOf(model);
    if (owners.size() != coupling.surfaces.size()) {
        warnOfLoneGroups(model, owners, coupling.warnedGroups);
        warnOfThinProximity(model, owners, coupling.warnedThin);
    }
    const bool same = std::ranges::equal(owners, coupling.surfaces, {}, &Owner::name, &CollisionSurface::name);
    std::vector<bool> added;
    for (std::size_t s = 0; !same && s < owners.size(); ++s)
        added.push_back(std::ranges::find(coupling.surfaces, owners[s].name, &CollisionSurface::name) ==
                        coupling.surfaces.end());
    coupling.surfaces.resize(owners.size());
    for (std::size_t s = 0; s < owners.size(); ++s) {
        const Owner& owner = owners[s];
        coupling.surfaces[s].name = owner.name;
        coupling.surfaces[s].cuttable =
            owner.soft && mayBeCut(model.softBodies[owner.body], owner.collision->shape->group);
        placeSurface(owner, state, coupling.rigid, coupling.normals, coupling.surfaces[s]);
    }
    coupling.sides = state.sides;
    findProximities(coupling.surfaces, dt, pool, coupling.sides, coupling.proximityScratch, coupling.proximities);
    if (!same) noteStartsInside(model, owners, added, coupling);
    addDeepPoints(owners, coupling);

    for (const Proximity& found : coupling.proximities) {
        const std::array<const Owner*, 2> sides{&owners[static_cast<std::size_t>(found.surfaces[0])],
                                                &owners[static_cast<std::size_t>(found.surfaces[1])]};
        const auto leftOut = [&](std::size_t side) {
            return insideOut(*sides[side], found, side, state) && !rigidTells(*sides[1 - side], found, side);
        };
        if (leftOut(0) || leftOut(1)) continue;
        const double proximity = sides[0]->collision->proximity + sides[1]->collision->proximity;
        const double gap =
            found.gap - insetAt(*sides[0]->collision, found, 0) - insetAt(*sides[1]->collision, found, 1);
        if (!(gap < proximity + comingNearer(coupling.surfaces, found, dt))) continue;
        Link& link = coupling.links.emplace_back();
        for (std::size_t side = 0; side < 2; ++side)
            link.sides[side] =
                pointOf(*sides[side], found, side, coupling.surfaces[static_cast<std::size_t>(found.surfaces[side])],
                        state, coupling.rigid);
        link.frame = frameOf(found.normal);
        link.friction = std::sqrt(frictionOf(model, *sides[0]) * frictionOf(model, *sides[1]));
        const Vec3 point = 0.5 * (link.sides[0].position + link.sides[1].position);
        coupling.contacts.push_back({.memory = {sides[0]->name.body, sides[1]->name.body, found.feature, point, {}},
                                     .gap = gap,
                                     .proximity = proximity,
                                     .skin = kSkin * proximity});
    }
    inheritForces(dt, state.contacts, coupling);
    for (std::size_t c = 0; c < coupling.contacts.size(); ++c)
        setLaw(method, dt, coupling.contacts[c], coupling.links[c]);
    // Between two that go where they are told nothing is solved, and what they start from would be told as a force.
    for (Link& link : coupling.links)
        if (!movable(link.sides[0], coupling.rigid) && !movable(link.sides[1], coupling.rigid)) link.impulse = {};
}

void keepContacts(double dt, const Coupling& coupling, State& state, physics::StepReport& report)
{
    if (dt == 0.0) return;
    state.contacts.clear();
    state.touching.clear();
    report.contacts.found = static_cast<int>(coupling.contacts.size());
    const std::vector<bool> noWayOut = contradicted(coupling);
    for (std::size_t c = 0; c < coupling.contacts.size(); ++c) {
        const FoundContact& contact = coupling.contacts[c];
        const Link& link = coupling.links[c];
        const Vec3 force = 1.0 / dt * link.impulse;
        state.touching.push_back({.first = contact.memory.first,
                                  .second = contact.memory.second,
                                  .point = contact.memory.point,
                                  .normal = link.frame[0],
                                  .gap = contact.gap,
                                  .normalForce = force.x,
                                  .friction = force.y * link.frame[1] + force.z * link.frame[2]});
        report.contacts.active += force.x != 0.0 ? 1 : 0;
        report.contacts.penetration = std::max(report.contacts.penetration, -contact.gap);
        if (!(link.next.x > 0.0) || noWayOut[c]) continue;
        ContactMemory& memory = state.contacts.emplace_back(contact.memory);
        memory.force = 1.0 / dt * inWorld(link.frame, link.next);
    }
    sortMemories(state.contacts);
    state.sides = coupling.sides;
}

} // namespace filasofia::engine
