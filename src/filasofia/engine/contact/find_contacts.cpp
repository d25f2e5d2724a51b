#include "filasofia/engine/contact/find_contacts.h"

#include "filasofia/engine/contact/contact_surfaces.h"
#include "filasofia/engine/contact/everted_tissue.h"
#include "filasofia/engine/contact/intersections.h"
#include "filasofia/engine/contact/islands.h"
#include "filasofia/engine/contact/part_crossings.h"
#include "filasofia/engine/contact/pinned_contacts.h"
#include "filasofia/engine/contact/rest_gap.h"
#include "filasofia/engine/contact/starts_inside.h"
#include "filasofia/engine/contact/turned_contact.h"
#include "filasofia/engine/contact/warm_start.h"
#include "filasofia/physics/intersection_force.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace filasofia::engine {
namespace {

// Surfaces that are inside each other part by kRecovery of their depth per step, at kRecoverySpeed at most: pushed out
// at once they would fly apart. Within the skin the fraction is kSkinRecovery. Impulses that are carried from step
// to step and grow with a gap are an oscillator, which is stable only if the penalty is more than this fraction of the
// mass that it moves.
constexpr double kRecovery = 0.2, kSkinRecovery = 0.05;
constexpr double kRecoverySpeed = 0.1; ///< [m/s]
// A rigid body may have no room between kinematic bodies: the carried impulse would grow without bound. Where it
// presses against them, it therefore loses this fraction per step, and more if the bodies overlap deeper than at rest.
// This makes a body sink in by micrometres: its penalty bears 99 % of its weight. Between bodies that both can move,
// impulses are in balance with what presses from outside, and lose nothing: else a needle would slip out of the jaws.
constexpr double kRigidLoss = 0.02, kDeepRigidLoss = 0.2;
// The force that is left is proportional to the penalty. Between rigid bodies at rest the penalty is so large that they
// stand like one body, which would be hundreds of kilonewtons for half a millimetre too little room: the penalty falls
// with the depth, to this fraction of it where the surfaces are through the skin.
constexpr double kDeepPenalty = 0.01;
// [-] Relative to the skin: rigid bodies that are in each other by more may push each other from opposite sides. Their
// impulses grew until they threw one away at 6 m/s.
constexpr double kLost = 10.0;
// Lines that would have passed through each other are pressed together by forces that the usual penalty misses by half
// a radius, and each new solve only by a quarter less. A stiffer one costs no iterations: the filter of rods is exact.
constexpr double kLinePenalty = 100.0;
// [-] Strands of a knot that is drawn tight slide on each other, and the usual penalty lets them into each other deeper
// in each step, until they lie in one line: no direction leads out of that, steps took a thousand iterations, and the
// knot stood still. Now the penalty grows with the depth, relative to the diameter of the thicker line, by this factor,
// up to that of lines which would have passed. As stiff from the start, loose threads fail to converge two to eight
// times as often.
constexpr double kDeepLinePenalty = 300.0;
// [-] The same of a line in a rigid body, where it begins at this depth: from the start on, the corners of a polygon
// would be felt. Without it a bar that was drawn through a taut thread at 0.3 m/s came through.
constexpr double kCorners = 0.1;
// [-] An impulse that changes leaves a gap behind, in proportion to its rate over the penalty. The gap lags, so the
// impulse does work: it drives what slides without friction, and only damping of the tissue stops that. Blocks under a
// ball wandered by 10 to 40 mm/s for ever. The penalty therefore grows as the step over the damping time, squared.
// Friction takes the work instead, from kLubricated on.
constexpr double kSlippery = 16.0, kMostSlippery = 64.0, kLubricated = 0.05;

/// [m] the distance by which the two sides approach in the time of the look-ahead.
double comingNearer(const std::vector<CollisionSurface>& surfaces, const Proximity& found, double dt)
{
    return kStepsAhead * dt * std::max(0.0, closingSpeed(surfaces, found));
}

/// Lets the edges of a rod that a point belongs to turn it about them. `arm` [m]: from the centre line to the surface.
void addSpins(const SoftBody& body, Vec3 arm, BodyPoint& point)
{
    const std::vector<Vec3>& x = body.state.x;
    const std::size_t edges = body.model.rod.edges.size(), nodes = x.size();
    const auto first = static_cast<std::size_t>(point.nodes[0]);
    std::array<std::size_t, 2> around{}; // the edge between two nodes, or both edges at one
    std::size_t count = 0;
    if (point.count == 2) {
        const auto second = static_cast<std::size_t>(point.nodes[1]);
        around[count++] = wrapped(first + 1, nodes) == second ? first : second;
    } else {
        const std::size_t before = wrapped(first + nodes - 1, nodes);
        if ((first > 0 || edges == nodes) && !isCut(body.model.rod, before)) around[count++] = before;
        if (first < edges && !isCut(body.model.rod, first)) around[count++] = first;
    }
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t e = around[k];
        const Vec3 direction = normalized(x[wrapped(e + 1, nodes)] - x[e], {});
        point.edges[k] = static_cast<int>(e);
        point.perSpin[k] = 1.0 / static_cast<double>(count) * cross(direction, arm);
        point.velocity += body.state.rod.spins[e] * point.perSpin[k];
    }
}

/// [m] From a place on lines or points to the surface around them.
Vec3 armOf(const CollisionModel& collision, const Proximity& found, std::size_t side)
{
    return (side == 0 ? -1.0 : 1.0) * collision.round * found.normal;
}

/// In place, as points are large: copies were a third of the time of writing contacts.
void writePoint(const SurfaceOwner& owner, const Proximity& found, std::size_t side, const CollisionSurface& surface,
                const Scene& scene, const RigidPlan& plan, BodyPoint& point)
{
    point.of = owner.soft ? BodyPoint::Of::Soft : BodyPoint::Of::Rigid;
    point.body = owner.soft ? owner.body : owner.plan;
    for (std::size_t k = 0; k < 3; ++k) {
        const double weight = found.weights[side][k];
        if (found.vertices[side][k] < 0 || weight == 0.0) continue;
        const auto vertex = static_cast<std::size_t>(found.vertices[side][k]);
        point.position += weight * surface.x[vertex];
        if (!owner.soft) continue;
        const geometry::Embedding& embedding = owner.collision->embedding;
        for (std::size_t n = 0; n < 4; ++n)
            point.add(embedding.nodes[vertex][n], weight * embedding.weights[vertex][n]);
    }
    if (owner.soft) {
        const std::vector<Vec3>& v = scene.soft[owner.body].state.v;
        for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k)
            point.velocity += point.weights[k] * v[static_cast<std::size_t>(point.nodes[k])];
        if (const SoftBody& body = scene.soft[owner.body]; isRod(body.model))
            addSpins(body, armOf(*owner.collision, found, side), point);
    } else {
        const RigidPlanElement& element = plan[owner.plan];
        point.position += armOf(*owner.collision, found, side);
        point.velocity = element.velocity + cross(element.angularVelocity, point.position - element.centre);
    }
}

// The gap that contacts keep, relative to the sum of both proximities. Surfaces at rest stay apart by this little, so
// that it is clear which side is outside: if the skin were 0, half of them would be inside.
constexpr double kSkin = 0.01;

constexpr double kContactTolerance = 1e-6; ///< [m] how much too far a surface may go in a step, whatever its proximity
/// Relative to the proximity: tissue may go this much farther, and comes back in the next step.
constexpr double kSoftTolerance = 0.02;

/// Sets the law of a contact from its gap.
void setLaw(const physics::ContactMethod& method, double dt, Constraint& constraint)
{
    const ContactInfo& contact = constraint.contact;
    const double gap = contact.gap - contact.skin;
    if (const auto* penalty = std::get_if<physics::PenaltyContact>(&method)) {
        constraint.softness = dt * (dt * penalty->stiffness + penalty->damping);
        // If the surfaces are apart, only the part of the motion that leads inside is resisted, damper included.
        constraint.bias = {gap > 0.0 ? gap / dt : dt * penalty->stiffness * gap / constraint.softness, 0.0, 0.0};
        return;
    }
    constraint.impulse = dt * inFrame(constraint.frame, contact.cached.force);
    const auto isSoft = [](const BodyPoint& point) { return point.of == BodyPoint::Of::Soft; };
    const bool anySoft = std::ranges::any_of(constraint.sides, isSoft);
    const double depth = contact.skin > 0.0 ? std::clamp(-gap / contact.skin, 0.0, 1.0) : 0.0; // in skins
    if (!anySoft) {
        constraint.trappedLoss = kRigidLoss + depth * (kDeepRigidLoss - kRigidLoss);
        constraint.trappedYielding = 1.0 / (1.0 + depth * (1.0 / kDeepPenalty - 1.0));
        if (contact.skin > 0.0)
            constraint.lostLoss = kDeepRigidLoss * std::clamp(-gap / (kLost * contact.skin) - 1.0, 0.0, 1.0);
    }
    constraint.impulse.x = std::max(0.0, constraint.impulse.x);
    // A contact that pushed in the last step may rest within the skin; all others may approach up to the skin.
    const double resting = constraint.impulse.x > 0.0 ? contact.skin : 0.0;
    const double shallow = std::clamp(gap, -contact.skin, resting), deep = std::min(0.0, gap + contact.skin);
    const double recovery = std::max(kSkinRecovery * shallow + kRecovery * deep, -kRecoverySpeed * dt);
    constraint.bias = inFrame(constraint.frame, contact.sliding);
    constraint.bias.x = (recovery + std::max(0.0, gap - resting) + contact.turning) / dt;
    const double soft = anySoft ? kSoftTolerance * contact.proximity : 0.0;
    constraint.tolerance =
        std::max({kSkinRecovery * contact.skin, contact.gap - dt * constraint.bias.x, soft, kContactTolerance}) / dt;
}

double frictionOf(const Scene& scene, const SurfaceOwner& owner)
{
    return owner.soft ? scene.soft[owner.body].model.friction : scene.rigid[owner.body].model.friction;
}

bool movable(const BodyPoint& point, const RigidPlan& plan)
{
    return (point.of == BodyPoint::Of::Soft && point.count > 0) || planPlace(plan, point).has_value();
}

/// Writes the contact at a proximity whose gap is known: in place, as it is large.
void writeContact(const Proximity& found, double gap, const std::array<const SurfaceOwner*, 2>& sides,
                  const StepContext& context, const Scene& scene, const Coupling& coupling, Constraint& contact)
{
    const std::vector<CollisionSurface>& surfaces = coupling.detection.surfaces;
    const double proximity = sides[0]->collision->proximity + sides[1]->collision->proximity;
    for (std::size_t side = 0; side < 2; ++side)
        writePoint(*sides[side], found, side, surfaces[static_cast<std::size_t>(found.surfaces[side])], scene,
                   coupling.rigid, contact.sides[side]);
    contact.frame = frameOf(found.normal);
    contact.friction = found.parting ? 0.0 : std::sqrt(frictionOf(scene, *sides[0]) * frictionOf(scene, *sides[1]));
    const Vec3 point = 0.5 * (contact.sides[0].position + contact.sides[1].position);
    ContactInfo& info = contact.contact;
    info.cached.first = sides[0]->name.body;
    info.cached.second = sides[1]->name.body;
    info.cached.feature = found.feature;
    info.cached.point = point;
    info.gap = gap;
    info.proximity = proximity;
    info.skin = kSkin * proximity;
    info.passing = info.parting = found.parting;
    if (std::holds_alternative<physics::ExactContact>(context.method))
        turnContact(context.dt, coupling.rigid,
                    {armOf(*sides[0]->collision, found, 0), armOf(*sides[1]->collision, found, 1)}, contact);
}

/// Factor on the penalty between two lines, or between a line and a rigid body.
double linePenalty(const std::array<const SurfaceOwner*, 2>& sides, double gap, const Scene& scene)
{
    double radius = 0.0, allowed = 0.0; // [m], [-]
    for (const SurfaceOwner* side : sides) {
        if (isLine(scene, *side))
            radius = std::max(radius, scene.soft[side->body].model.rod.radius);
        else if (side->soft)
            return 1.0;
        else
            allowed = kCorners;
    }
    if (radius == 0.0) return 1.0;
    return std::clamp(kDeepLinePenalty * (-gap / (2.0 * radius) - allowed), 1.0, kLinePenalty);
}

/// Factor on the penalty between tissue and something that it slides on without friction.
double slipperyPenalty(const std::array<const SurfaceOwner*, 2>& sides, double dt, double friction, const Scene& scene)
{
    double damping = std::numeric_limits<double>::infinity(); // [s]
    for (const SurfaceOwner* side : sides)
        if (side->soft && !isRod(scene.soft[side->body].model))
            damping = std::min(damping, scene.soft[side->body].model.rayleigh.stiffness);
    const double share = kSlippery * dt / (dt + damping); // 0 between rigid bodies
    const double factor = std::clamp(share * share, 1.0, kMostSlippery);
    return 1.0 + std::max(0.0, 1.0 - friction / kLubricated) * (factor - 1.0);
}

/// Adds the contact at a proximity, unless it must be left out.
void addContact(Proximity& found, const std::array<const SurfaceOwner*, 2>& sides, const StepContext& context,
                const Scene& scene, Coupling& coupling)
{
    for (const std::size_t side : {0U, 1U})
        if (onInvertedElement(*sides[side], found, side, scene) &&
            !staysAtInverted(*sides[1 - side], coupling.detection.surfaces, context.dt, side, found))
            return;
    const double proximity = sides[0]->collision->proximity + sides[1]->collision->proximity;
    double gap = found.gap - insetAt(*sides[0]->collision, found, 0) - insetAt(*sides[1]->collision, found, 1);
    if (const double skin = kSkin * proximity; found.surfaces[0] == found.surfaces[1] && gap < skin && !found.parting)
        gap += nearerAtRest(*sides[0], found, skin,
                            coupling.detection.surfaces[static_cast<std::size_t>(found.surfaces[0])],
                            coupling.detection.normals);
    if (!(gap < proximity + comingNearer(coupling.detection.surfaces, found, context.dt))) return;
    Constraint& contact = coupling.constraints.emplace_back();
    writeContact(found, gap, sides, context, scene, coupling, contact);
    if (std::holds_alternative<physics::ExactContact>(context.method) && arePinned(contact, scene))
        return coupling.constraints.pop_back();
    contact.yielding = linePenalty(sides, gap, scene) * slipperyPenalty(sides, context.dt, contact.friction, scene);
}

} // namespace

void findContacts(const StepContext& context, const Scene& scene, Coupling& coupling)
{
    const double dt = context.dt;
    coupling.constraints.clear();
    coupling.contactCount = coupling.weldCount = coupling.channelCount = coupling.clipLegCount = 0;
    if (dt == 0.0) return;

    ContactDetection& detection = coupling.detection;
    const std::vector<SurfaceOwner> owners = surfaceOwners(scene);
    const std::vector<bool> added = placeSurfaces(context, scene, owners, coupling);
    detection.sides = scene.sides;
    detection.pushed.clear();
    for (const CachedContact& each : scene.contacts)
        detection.pushed.push_back({each.first, each.second, each.feature});
    findProximities(detection.surfaces, dt, context.pool, detection.pushed, detection.sides, detection.scratch,
                    detection.proximities);
    if (!added.empty()) noteStartsInside(owners, added, coupling);
    addDeepPoints(owners, detection);
    partCrossings(context, scene, owners, detection);

    detection.followed.clear();
    for (Proximity& found : detection.proximities) {
        const std::array<const SurfaceOwner*, 2> sides{&owners[static_cast<std::size_t>(found.surfaces[0])],
                                                       &owners[static_cast<std::size_t>(found.surfaces[1])]};
        const std::size_t before = coupling.constraints.size();
        addContact(found, sides, context, scene, coupling);
        detection.followed.push_back(coupling.constraints.size() > before ? 1 : 0);
    }
    const std::vector<std::array<int, 2>> crossing = reportIntersections(context, scene, owners, added, coupling);
    if (!added.empty()) warnOfStartsInside(scene, owners, added, crossing, coupling);
    coupling.contactCount = coupling.constraints.size();
    inheritForces(dt, scene.contacts, coupling.contacts());
    for (Constraint& contact : coupling.contacts()) setLaw(context.method, dt, contact);
    // Nothing is solved between two immovable bodies, and the warm start would be reported as a force.
    for (Constraint& contact : coupling.contacts())
        if (!movable(contact.sides[0], coupling.rigid) && !movable(contact.sides[1], coupling.rigid))
            contact.impulse = {};
}

void addMissed(const StepContext& context, std::span<const MissedContact> missed, const Scene& scene,
               Coupling& coupling)
{
    const std::vector<SurfaceOwner> owners = surfaceOwners(scene);
    std::vector<Constraint> added;
    for (const MissedContact& pass : missed) {
        const std::array<const SurfaceOwner*, 2> sides{&owners[static_cast<std::size_t>(pass.at.surfaces[0])],
                                                       &owners[static_cast<std::size_t>(pass.at.surfaces[1])]};
        const double gap =
            pass.at.gap - insetAt(*sides[0]->collision, pass.at, 0) - insetAt(*sides[1]->collision, pass.at, 1);
        Constraint& contact = added.emplace_back();
        writeContact(pass.at, gap, sides, context, scene, coupling, contact);
        setLaw(context.method, context.dt, contact);
        contact.contact.passing = true;
        if (pass.line) {
            contact.friction = 0.0;
            contact.yielding = kLinePenalty;
        }
    }
    coupling.constraints.insert(coupling.constraints.begin() + static_cast<std::ptrdiff_t>(coupling.contactCount),
                                added.begin(), added.end());
    coupling.contactCount += added.size();
}

void keepContacts(const StepContext& context, const Coupling& coupling, Scene& scene)
{
    const double dt = context.dt;
    if (dt == 0.0) return;
    scene.contacts.clear();
    scene.contactReports.clear();
    physics::ContactReport& report = context.report.contacts;
    report.found = static_cast<int>(coupling.contacts().size());
    const std::vector<bool> noWayOut = contradicted(coupling.contacts());
    for (std::size_t c = 0; c < coupling.contacts().size(); ++c) {
        const Constraint& constraint = coupling.contacts()[c];
        const ContactInfo& contact = constraint.contact;
        const Vec3 force = 1.0 / dt * constraint.impulse;
        scene.contactReports.push_back({.first = contact.cached.first,
                                        .second = contact.cached.second,
                                        .point = contact.cached.point,
                                        .normal = constraint.frame[0],
                                        .gap = contact.gap,
                                        .normalForce = force.x,
                                        .friction = force.y * constraint.frame[1] + force.z * constraint.frame[2]});
        report.active += force.x != 0.0 ? 1 : 0;
        if (!contact.parting) report.penetration = std::max(report.penetration, -contact.gap);
        if (!(constraint.multiplier.x > 0.0) || noWayOut[c] || contact.passing) continue;
        CachedContact& cached = scene.contacts.emplace_back(contact.cached);
        cached.force = 1.0 / dt * inWorld(constraint.frame, constraint.multiplier);
    }
    for (const frame::Contact& each : scene.contactReports) physics::addForce(each, context.report.intersections);
    sortCache(scene.contacts);
    scene.sides = coupling.detection.sides;
}

} // namespace filasofia::engine
