#include "filasofia/sofa/make_tie.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/embedding.h"
#include "filasofia/physics/held_whole.h"
#include "filasofia/sofa/near_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <ranges>

namespace filasofia::sofaengine {
namespace {

/// In what is left of a body.
std::vector<TiePoint> embedded(const SoftNode& body, std::span<const Vec3> places)
{
    SoftState now;
    body.read(now);
    geometry::TetMesh left{.nodes = now.positions, .tetrahedra = {}};
    const SoftPlan& plan = body.plan();
    for (std::size_t t = 0; t < plan.mesh.tetrahedra.size(); ++t)
        if (plan.gone.empty() || plan.gone[t] == 0) left.tetrahedra.push_back(plan.mesh.tetrahedra[t]);
    const geometry::Embedding found = geometry::embed(left, places);
    std::vector<TiePoint> points;
    for (std::size_t i = 0; i < places.size(); ++i)
        points.push_back({.nodes = found.nodes[i], .weights = found.weights[i]});
    return points;
}

/// The nodes nearest to places, of those that are left of a body.
std::vector<TiePoint> nearest(const std::vector<Vec3>& nodes, const std::vector<char>& gone,
                              std::span<const Vec3> places)
{
    std::vector<TiePoint> points;
    for (const Vec3 place : places) {
        const auto far = [&](std::size_t node) {
            return gone[node] != 0 ? std::numeric_limits<double>::infinity() : lengthSquared(nodes[node] - place);
        };
        const auto best = std::ranges::min(std::views::iota(std::size_t{0}, nodes.size()), {}, far);
        points.push_back({.nodes = {static_cast<int>(best), 0, 0, 0}});
    }
    return points;
}

Tie::Side sideOf(BodyId id, SofaScene& scene)
{
    const Tie::Side side{.soft = findBody(scene.soft, id), .rigid = findBody(scene.rigid, id)};
    if (id && !side.soft && !side.rigid) fail("body ", id.value, " could not be made when it was added");
    return side;
}

/// [-] times the size of the other body: how near counts if an attachment selects nothing, as in the native engine.
constexpr double kNearby = 0.01;

/// Adds the nodes that are near the other body, or inside it.
void addNodesNear(const physics::AttachmentDef& def, const std::vector<Vec3>& nodes, const Tie::Side& other,
                  std::vector<int>& out)
{
    NearSurface near({}, {});
    Pose pose;
    if (other.soft) {
        SoftState now;
        other.soft->read(now);
        near = NearSurface(now.positions, other.soft->plan().surface);
    } else {
        RigidState now;
        other.rigid->read(now);
        pose = inverse(now.poses[static_cast<std::size_t>(def.element)]);
        const auto mesh = physics::loadMesh(other.rigid->plan().def.mesh, "mesh");
        near = NearSurface(mesh->vertices, mesh->triangles);
    }
    const double within = def.within.value_or(kNearby * near.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (near.has(transform(pose, nodes[i]), within)) out.push_back(static_cast<int>(i));
    std::ranges::sort(out);
    out.erase(std::ranges::unique(out).begin(), out.end());
}

/// A side of a tie in the making.
struct Half {
    Tie::Side side;
    TieEnd end;
    std::vector<TiePoint> points = {};
    std::vector<Vec3> places = {}; ///< [m] where its points are now
};
Half halfOf(BodyId id, int element, SofaScene& scene) { return {sideOf(id, scene), {.id = id, .element = element}}; }

/// Puts points of a rigid element at places.
void pointAt(std::span<const Vec3> places, Half& half)
{
    RigidState now;
    half.side.rigid->read(now);
    const Pose pose = now.poses[static_cast<std::size_t>(half.end.element)];
    for (const Vec3 place : places) {
        half.points.push_back({.nodes = {static_cast<int>(half.points.size()), 0, 0, 0}});
        half.end.points.push_back(rotate(conjugate(pose.orientation), place - pose.position) -
                                  half.side.rigid->plan().inertia.centre);
        half.places.push_back(place);
    }
}

/// Gives the second side points where those of the first are, or nearest to them, or as the Def says.
void meet(const std::vector<Vec3>& places, const physics::AttachmentDef* def, Half& other)
{
    if (other.side.rigid) pointAt(places, other);
    if (!other.side.soft) return;
    SoftState now;
    other.side.soft->read(now);
    if (def && !def->toNodes.empty())
        for (const int node : def->toNodes) other.points.push_back({.nodes = {node, 0, 0, 0}});
    else if (def && def->mode == physics::AttachMode::Nearest)
        other.points = nearest(now.positions, goneNodes(other.side.soft->plan()), places);
    else
        other.points = embedded(*other.side.soft, places);
    for (const TiePoint& point : other.points) {
        Vec3& place = other.places.emplace_back();
        for (std::size_t k = 0; k < 4; ++k)
            place += point.weights[k] * now.positions[static_cast<std::size_t>(point.nodes[k])];
    }
}

double gyration(const RigidNode& body)
{
    const physics::RigidInertia& inertia = body.plan().inertia;
    const auto surface = inertia.mass > 0.0 ? nullptr : physics::loadMesh(body.plan().def.mesh, "mesh");
    return physics::gyration(inertia, surface.get());
}

/// The points by which an element is held as a whole.
std::vector<Vec3> pointsAround(const Tie::Side& body, const Tie::Side& other)
{
    double radius = body.rigid->plan().def.dynamic ? gyration(*body.rigid) : 0.0;
    if (radius == 0.0 && other.rigid) radius = gyration(*other.rigid);
    if (radius == 0.0 && other.soft) {
        const geometry::Box box = geometry::boxAround(other.soft->plan().mesh.nodes);
        radius = 0.25 * length(box.high - box.low);
    }
    return physics::pointsAround(body.rigid->plan().inertia.centre, radius);
}

/// Leaves out the pairs of which a node is of a removed piece; false if none is left.
bool leaveOutGone(Half& body, Half& other)
{
    const auto goneOf = [](const Half& half) {
        return half.side.soft ? goneNodes(half.side.soft->plan()) : std::vector<char>{};
    };
    const std::vector<char> gone = goneOf(body), otherGone = goneOf(other);
    const auto isGone = [](const Half& half, std::size_t i, const std::vector<char>& nodes) {
        return half.side.soft && dependsOn(half.points[i], nodes);
    };
    for (std::size_t i = body.points.size(); i-- > 0;) {
        if (!isGone(body, i, gone) && !isGone(other, i, otherGone)) continue;
        for (Half* each : {&body, &other}) {
            if (i >= each->points.size()) continue; // space has none
            each->points.erase(each->points.begin() + static_cast<std::ptrdiff_t>(i));
            each->places.erase(each->places.begin() + static_cast<std::ptrdiff_t>(i));
        }
    }
    return !body.points.empty();
}

/// Whether a contact is where a body in these poses grasps.
bool isGrasped(const physics::Grasp& grasp, const frame::Contact& contact, const std::vector<Pose>& poses)
{
    if (!grasp.def.mouth) return true;
    return physics::isInMouth(*grasp.def.mouth, poses[static_cast<std::size_t>(grasp.def.mouth->element)],
                              contact.point, contact.first == grasp.rigid ? contact.normal : -contact.normal);
}

void keep(AttachmentId id, const Half& body, const Half& other, const TieLaw& law, bool grasp, SofaScene& scene)
{
    TieState state{.body = body.end, .to = other.end, .law = law, .grasp = grasp};
    const bool space = !other.end.id, weld = !std::isfinite(law.stiffness);
    for (std::size_t i = 0; i < body.points.size(); ++i) {
        TieRows::Pair& pair = state.pairs.emplace_back(TieRows::Pair{.first = body.points[i]});
        if (!space) pair.second = other.points[i];
        if (space)
            pair.apart = body.places[i];
        else if (weld) // it is drawn together; a spring pulls
            pair.apart = body.places[i] - other.places[i];
    }
    state.whole = state.pairs;
    state.report = {.id = id, .body = body.end.id, .to = other.end.id, .points = static_cast<int>(state.pairs.size())};
    auto tie = makeTie(state, scene);
    const auto place = std::ranges::upper_bound(scene.ties, id, {}, [](const auto& each) { return each->id(); });
    scene.ties.insert(place, std::move(tie));
    scene.contact.join({});
}

} // namespace

bool isTie(const physics::AttachmentDef& def) { return def.to || std::isfinite(def.breakForce); }

std::unique_ptr<Tie> makeTie(const TieState& state, SofaScene& scene)
{
    const std::array sides{sideOf(state.body.id, scene), sideOf(state.to.id, scene)};
    std::vector<SoftNode*> coupled;
    try {
        for (const Tie::Side& side : sides)
            if (side.soft && !side.soft->isCoupled()) {
                side.soft->setCoupled(true);
                coupled.push_back(side.soft);
            }
        return std::make_unique<Tie>(state, sides[0], sides[1], *scene.root);
    } catch (...) {
        for (SoftNode* each : coupled) each->setCoupled(false);
        throw;
    }
}

bool addTie(AttachmentId id, BodyId body, const physics::AttachmentDef& def, SofaScene& scene)
{
    startConstraints(scene);
    Half side = halfOf(body, 0, scene), other = halfOf(def.to, def.element, scene);
    SoftState now;
    side.side.soft->read(now);
    std::vector<int> nodes = def.toNodes.empty() ? nodesOf(def, now.positions) : def.nodes;
    const bool selects = !def.nodes.empty() || def.box || def.ball;
    if (def.within || !selects) addNodesNear(def, now.positions, other.side, nodes);
    const std::vector<char> gone = goneNodes(side.side.soft->plan());
    if (def.toNodes.empty()) // else they are pairs
        std::erase_if(nodes, [&](int node) { return gone[static_cast<std::size_t>(node)] != 0; });
    for (const int node : nodes) {
        side.points.push_back({.nodes = {node, 0, 0, 0}});
        side.places.push_back(now.positions[static_cast<std::size_t>(node)]);
    }
    if (side.places.empty()) return false;
    meet(side.places, &def, other);
    if (!leaveOutGone(side, other)) return false;
    keep(id, side, other, {def.stiffness, def.breakForce, def.pointBreakForce, def.cutDistance}, false, scene);
    return true;
}

bool addTie(AttachmentId id, BodyId body, const physics::RigidAttachmentDef& def, SofaScene& scene)
{
    startConstraints(scene);
    Half side = halfOf(body, def.element, scene), other = halfOf(def.to, def.toElement, scene);
    RigidState now;
    side.side.rigid->read(now);
    std::vector<Vec3> places;
    for (const Vec3 point : def.points.empty() ? pointsAround(side.side, other.side) : def.points)
        places.push_back(transform(now.poses[static_cast<std::size_t>(def.element)], point));
    pointAt(places, side);
    meet(side.places, nullptr, other);
    keep(id, side, other, {.stiffness = def.stiffness, .breakForce = def.breakForce}, false, scene);
    return true;
}

// Reports name the target as the attached body. A body with several elements is tied by the one with most contacts.
bool addTie(const physics::Grasp& grasp, SofaScene& scene)
{
    std::map<int, std::vector<Vec3>> touched; // per element
    std::map<int, int> targets;
    RigidState now;
    if (const RigidNode* jaw = findBody(scene.rigid, grasp.rigid)) jaw->read(now);
    for (const FoundContact& each : scene.contacts) {
        const frame::Contact& contact = each.contact;
        const bool turned = contact.first == grasp.target && contact.second == grasp.rigid;
        if (contact.normalForce <= 0.0 || !(turned || (contact.first == grasp.rigid && contact.second == grasp.target)))
            continue;
        if (!isGrasped(grasp, contact, now.poses)) continue;
        touched[turned ? each.secondElement : each.firstElement].push_back(contact.point);
        targets[turned ? each.secondElement : each.firstElement] = turned ? each.firstElement : each.secondElement;
    }
    if (touched.empty()) return false;
    startConstraints(scene);
    const auto most = std::ranges::max_element(touched, {}, [](const auto& each) { return each.second.size(); });
    Half side = halfOf(grasp.target, targets[most->first], scene), other = halfOf(grasp.rigid, most->first, scene);
    pointAt(most->second, other);
    if (side.side.rigid)
        pointAt(most->second, side);
    else
        side.points = embedded(*side.side.soft, most->second);
    side.places = most->second;
    keep(grasp.id, side, other, {.stiffness = grasp.def.stiffness, .breakForce = grasp.def.breakForce}, true, scene);
    return true;
}

} // namespace filasofia::sofaengine
