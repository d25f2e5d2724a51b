#include "filasofia/sofa/make_tie.h"

#include "filasofia/core/error.h"
#include "filasofia/geometry/embedding.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace filasofia::sofaengine {
namespace {

constexpr const char* kLacks = " is not available with the engine 'sofa'"; // how every refusal ends

std::vector<TiePoint> embedded(const SoftNode& body, std::span<const Vec3> places)
{
    SoftState now;
    body.read(now);
    const geometry::Embedding found =
        geometry::embed({.nodes = now.positions, .tetrahedra = body.plan().mesh.tetrahedra}, places);
    std::vector<TiePoint> points;
    for (std::size_t i = 0; i < places.size(); ++i)
        points.push_back({.nodes = found.nodes[i], .weights = found.weights[i]});
    return points;
}

/// The nodes of a body nearest to places.
std::vector<TiePoint> nearest(const std::vector<Vec3>& nodes, std::span<const Vec3> places)
{
    std::vector<TiePoint> points;
    for (const Vec3 place : places) {
        const auto far = [&](Vec3 node) { return lengthSquared(node - place); };
        const auto best = std::ranges::min_element(nodes, {}, far);
        points.push_back({.nodes = {static_cast<int>(best - nodes.begin()), 0, 0, 0}});
    }
    return points;
}

/// The side of the body with this id; its points are still missing. Both sides of a tie must be coupled.
Tie::Side sideOf(BodyId id, int element, SofaScene& scene)
{
    Tie::Side side{.soft = findBody(scene.soft, id), .rigid = findBody(scene.rigid, id), .element = element};
    if (side.soft) side.soft->couple();
    if (id && !side.soft && !side.rigid) fail("body ", id.value, " could not be made when it was added");
    return side;
}

std::vector<Vec3> apartOf(const std::vector<TiePoint>& points, const std::vector<Vec3>& nodes,
                          const std::vector<Vec3>& places)
{
    std::vector<Vec3> apart;
    for (std::size_t i = 0; i < points.size(); ++i) {
        Vec3 place;
        for (std::size_t k = 0; k < 4; ++k)
            place += points[i].weights[k] * nodes[static_cast<std::size_t>(points[i].nodes[k])];
        apart.push_back(places[i] - place);
    }
    return apart;
}

/// Adds the points of the second side where the first's places are, and says how far the pairs are apart.
std::vector<Vec3> meet(const std::vector<Vec3>& places, const physics::AttachmentDef* def, Tie::Side& other)
{
    if (other.rigid) {
        other.places = places;
        return std::vector<Vec3>(places.size());
    }
    if (!other.soft) return places; // space
    SoftState now;
    other.soft->read(now);
    if (def && !def->toNodes.empty())
        for (const int node : def->toNodes) other.points.push_back({.nodes = {node, 0, 0, 0}});
    else if (def && def->mode == physics::AttachMode::Nearest)
        other.points = nearest(now.positions, places);
    else
        other.points = embedded(*other.soft, places);
    return apartOf(other.points, now.positions, places);
}

void keep(AttachmentId id, const Tie::Side& body, const Tie::Side& other, const Tie::Law& law,
          std::span<const Vec3> apart, SofaScene& scene)
{
    const auto place = std::ranges::upper_bound(scene.ties, id, {}, [](const auto& each) { return each->id(); });
    scene.ties.insert(place, std::make_unique<Tie>(id, body, other, law, apart, *scene.root));
    scene.contact.join({});
}

} // namespace

bool isTie(const physics::AttachmentDef& def) { return def.to || std::isfinite(def.breakForce); }

void checkTie(const physics::AttachmentDef& def, const std::string& object)
{
    if (def.within) fail(object, ".within", kLacks, ": select nodes");
    if (def.cutDistance > 0.0) fail(object, ".cutDistance", kLacks);
    if (def.nodes.empty() && !def.box && !def.ball)
        fail(object, ": selecting what is near the other body", kLacks, ": select nodes");
}

void checkTie(const physics::RigidAttachmentDef& def, const std::string& object)
{
    if (def.points.empty()) fail(object, ": attaching an element as a whole", kLacks, ": give points");
}

bool addTie(AttachmentId id, BodyId body, const physics::AttachmentDef& def, SofaScene& scene)
{
    startConstraints(scene);
    Tie::Side side = sideOf(body, 0, scene), other = sideOf(def.to, def.element, scene);
    SoftState now;
    side.soft->read(now);
    std::vector<Vec3> places;
    const std::vector<int> nodes = def.toNodes.empty() ? nodesOf(def, now.positions) : def.nodes;
    for (const int node : nodes) {
        side.points.push_back({.nodes = {node, 0, 0, 0}});
        places.push_back(now.positions[static_cast<std::size_t>(node)]);
    }
    if (places.empty()) return false;
    const std::vector<Vec3> apart = meet(places, &def, other);
    keep(id, side, other, {def.stiffness, def.breakForce, def.pointBreakForce}, apart, scene);
    return true;
}

bool addTie(AttachmentId id, BodyId body, const physics::RigidAttachmentDef& def, SofaScene& scene)
{
    startConstraints(scene);
    Tie::Side side = sideOf(body, def.element, scene), other = sideOf(def.to, def.toElement, scene);
    RigidState now;
    side.rigid->read(now);
    for (const Vec3 point : def.points)
        side.places.push_back(transform(now.poses[static_cast<std::size_t>(def.element)], point));
    const std::vector<Vec3> apart = meet(side.places, nullptr, other);
    keep(id, side, other, {.stiffness = def.stiffness, .breakForce = def.breakForce}, apart, scene);
    return true;
}

// Reports name the target as the attached body. A body with several elements is tied by the one with most contacts.
bool addTie(const physics::Grasp& grasp, SofaScene& scene)
{
    std::map<int, std::vector<Vec3>> touched; // per element
    std::map<int, int> targets;
    for (const FoundContact& each : scene.contacts) {
        const frame::Contact& contact = each.contact;
        const bool turned = contact.first == grasp.target && contact.second == grasp.rigid;
        if (contact.normalForce <= 0.0 || !(turned || (contact.first == grasp.rigid && contact.second == grasp.target)))
            continue;
        touched[turned ? each.secondElement : each.firstElement].push_back(contact.point);
        targets[turned ? each.secondElement : each.firstElement] = turned ? each.firstElement : each.secondElement;
    }
    if (touched.empty()) return false;
    startConstraints(scene);
    const auto most = std::ranges::max_element(touched, {}, [](const auto& each) { return each.second.size(); });
    Tie::Side side = sideOf(grasp.target, targets[most->first], scene), other = sideOf(grasp.rigid, most->first, scene);
    other.places = most->second;
    side.places = most->second;
    if (side.soft) side.points = embedded(*side.soft, most->second);
    keep(grasp.id, side, other, {.stiffness = grasp.def.stiffness, .breakForce = grasp.def.breakForce},
         std::vector<Vec3>(most->second.size()), scene);
    return true;
}

} // namespace filasofia::sofaengine
