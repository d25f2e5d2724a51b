#include "filasofia/engine/contact/contact_surfaces.h"

#include "filasofia/core/log.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

namespace filasofia::engine {
namespace {

/// Finds CollisionSurface::apexes.
void findApexes(const SoftModel& model, const CollisionModel& collision, CollisionSurface& out)
{
    out.apexesOf = collision.shape;
    out.apexes.clear();
    if (collision.behind.empty()) return;
    std::vector<int> vertexOf(model.rest.size(), -1);
    for (std::size_t v = 0; v < collision.embedding.nodes.size(); ++v)
        vertexOf[static_cast<std::size_t>(collision.embedding.nodes[v][0])] = static_cast<int>(v);
    for (const int node : collision.behind) out.apexes.push_back(vertexOf[static_cast<std::size_t>(node)]);
}

void placeSurface(double dt, const SurfaceOwner& owner, const Scene& scene, const RigidPlan& plan,
                  std::vector<Vec3>& normals, CollisionSurface& out)
{
    const CollisionModel& collision = *owner.collision;
    const std::size_t count = collision.shape->rest.size();
    out.shape = collision.shape;
    out.self = out.shape->self;
    out.x.resize(count);
    out.v.resize(count);
    if (owner.soft) {
        const SoftState& body = scene.soft[owner.body].state;
        const SoftModel& model = scene.soft[owner.body].model;
        const bool cut = model.opened && collision.own && out.shape->closed;
        out.self = out.shape->self || (cut && collision.selfOnceCut && !isSpared(model, collision));
        out.pieceOf.clear();
        if (out.self) findPieces(model, collision, out.pieceOf);
        if (out.self && out.apexesOf != out.shape) findApexes(model, collision, out);
        // What holds the body is not known yet. Without gravity, a cube that starts at rest 2 mm above a floor fell
        // 12 mm into it at 50 steps per second, and through it at 10.
        const Vec3 fall = model.gravity ? dt * scene.gravity : Vec3{};
        for (std::size_t i = 0; i < count; ++i) {
            out.x[i] = valueAt(i, collision.embedding, body.x);
            out.v[i] = valueAt(i, collision.embedding, body.v) + fall;
        }
        applyInset(*collision.shape, collision.inset, normals, out.x);
        return;
    }
    const RigidPlanElement& element = plan[owner.plan];
    const Pose& pose = scene.rigid[owner.body].state.poses[element.element];
    const Mat3 turn = toMat3(pose.orientation);
    const Vec3 velocity = element.velocity + element.change.linear,
               spin = element.angularVelocity + element.change.angular;
    out.spin = spin;
    for (std::size_t i = 0; i < count; ++i) {
        out.x[i] = pose.position + turn * collision.core[i];
        out.v[i] = velocity + cross(spin, out.x[i] - element.centre);
    }
}

/// Whether a body that meets itself in `other` need not do so in `mine`.
bool replaces(const CollisionModel& other, const CollisionModel& mine)
{
    const CollisionShape &a = *other.shape, &b = *mine.shape;
    const bool same = a.points == b.points && a.lines == b.lines && a.triangleFaces == b.triangleFaces;
    if (!other.own || !same || a.cutting || !(a.self || other.selfOnceCut)) return false;
    if (!mine.selfOnceCut) return true;
    return other.proximity > mine.proximity || (other.proximity == mine.proximity && &other < &mine); // of one list
}

bool isAttached(const Scene& scene, BodyId id)
{
    return std::ranges::any_of(scene.attachments,
                               [&](const Attachment& each) { return each.body == id || each.to == id; });
}

/// Whether the world or other bodies hold a body: it is pinned, attached, or in a hand.
bool isHeld(const Scene& scene, const SoftBody& body)
{
    return !body.model.pins.springs.empty() ||
           std::ranges::find(body.model.pins.hard, true) != body.model.pins.hard.end() ||
           isAttached(scene, body.model.id);
}
bool isHeld(const Scene& scene, const RigidBody& body)
{
    return !body.model.dynamic || !body.state.couplings.empty() || body.model.articulation.to ||
           isAttached(scene, body.model.id);
}

/// Whether some body falls unless another one bears it.
bool anyFalls(const Scene& scene)
{
    const auto falls = [&](const auto& body) { return body.model.gravity && !isHeld(scene, body); };
    return scene.gravity != Vec3{} &&
           (std::ranges::any_of(scene.soft, falls) || std::ranges::any_of(scene.rigid, falls));
}

/// Whether a surface has work to do without colliding: blades cut, and needles pierce, bodies without collision models.
bool worksAlone(const Scene& scene, const SurfaceOwner& owner)
{
    return owner.collision->shape->cutting || (!owner.soft && scene.rigid[owner.body].model.needle);
}

/// Logs a warning once per collision group that only one body has, if something would be borne otherwise: the body
/// itself is free, or another one falls. What is held, or moved by hand, may do all that it is for without contacts: it
/// may be cut, clipped, grasped by a region or only be looked at.
void warnOfLoneGroups(const Scene& scene, const std::vector<SurfaceOwner>& owners, std::set<int>& warned)
{
    if (scene.soft.size() + scene.rigid.size() < 2) return;
    const bool falling = anyFalls(scene);
    for (const SurfaceOwner& owner : owners) {
        const CollisionShape& shape = *owner.collision->shape;
        const bool held = owner.soft ? isHeld(scene, scene.soft[owner.body]) : isHeld(scene, scene.rigid[owner.body]);
        if (worksAlone(scene, owner) || (held && !falling)) continue;
        const auto meets = [&](const SurfaceOwner& each) {
            return (each.soft != owner.soft || each.body != owner.body) && each.collision->shape->group == shape.group;
        };
        const bool meetsItself = shape.self || (owner.collision->own && owner.collision->selfOnceCut && shape.closed &&
                                                scene.soft[owner.body].model.dynamicTopology);
        if (meetsItself || std::ranges::any_of(owners, meets)) continue;
        if (!warned.insert(shape.group).second) continue;
        const std::string body =
            owner.soft ? describe(scene.soft[owner.body].model) : text("rigid body '", nameOf(scene, owner), "'");
        logWarning(body, ": no other body has collision group ", shape.group, ": it collides with nothing");
    }
}

/// Logs a warning once per group if a soft body falls that only blades meet: all its collision models have `cutting`.
void warnOfTissueForBlades(const Scene& scene, std::set<int>& warned)
{
    if (scene.soft.size() + scene.rigid.size() < 2 || scene.gravity == Vec3{}) return;
    for (const SoftBody& body : scene.soft) {
        const std::vector<CollisionModel>& models = body.model.collision;
        const auto forBlades = [](const CollisionModel& each) { return each.shape->cutting; };
        if (models.empty() || !std::ranges::all_of(models, forBlades)) continue;
        if (!body.model.gravity || isHeld(scene, body)) continue;
        if (warned.insert(models.front().shape->group).second)
            logWarning(describe(body.model),
                       ": all its collision models have `cutting`: it collides with nothing without another one");
    }
}

/// Logs a warning once per group if a rigid body has blades, and none in a group of a body that may be cut, though
/// there are such bodies. Returns the bodies with these blades.
std::vector<BodyId> warnOfIdleBlades(const Scene& scene, std::set<int>& warned)
{
    std::vector<BodyId> idle;
    if (std::ranges::none_of(scene.soft, [](const SoftBody& each) { return each.model.dynamicTopology; })) return idle;
    const auto isBlade = [](const CollisionModel& each) { return each.shape->cutting; };
    const auto cuts = [&](const CollisionModel& blade) {
        return isBlade(blade) && std::ranges::any_of(scene.soft, [&](const SoftBody& each) {
                   return mayBeCut(each.model, blade.shape->group);
               });
    };
    for (const RigidBody& body : scene.rigid) {
        const std::vector<CollisionModel>& models = body.model.collision;
        const auto blade = std::ranges::find_if(models, isBlade);
        if (blade == models.end() || std::ranges::any_of(models, cuts)) continue;
        idle.push_back(body.model.id);
        if (const int group = blade->shape->group; warned.insert(group).second)
            logWarning("rigid body '", body.model.name, "': no body that may be cut has collision group ", group,
                       ": its blade cuts nothing");
    }
    return idle;
}

/// Surfaces at rest tell inside from outside only by their insets, a fraction of the proximities. Logs a warning once
/// per group if two proximities add up to hardly more than rounding and the motion in a step may be.
void warnOfThinProximity(const Scene& scene, const std::vector<SurfaceOwner>& owners, std::set<int>& warned)
{
    constexpr double thin = 1e-4; // [m]
    for (const SurfaceOwner& a : owners) {
        // True of nearly all bodies. Without this, a thousand bodies would be a million pairs.
        if (a.collision->proximity >= thin) continue;
        for (const SurfaceOwner& b : owners) {
            const CollisionShape &one = *a.collision->shape, &two = *b.collision->shape;
            const double both = a.collision->proximity + b.collision->proximity;
            if (!(a.name.body < b.name.body) || one.group != two.group || one.cutting || two.cutting || both >= thin)
                continue;
            if (warned.insert(one.group).second)
                logWarning("body '", nameOf(scene, a), "' and body '", nameOf(scene, b), "': the proximities of their ",
                           "collision models add up to ", both, " m: below ", thin, " m contacts may be missed");
        }
    }
}

/// The element of a rigid body that a surface belongs to, and the one that a joint connects it to; -1: none.
std::pair<int, int> linkOf(const SurfaceOwner& owner, const Scene& scene)
{
    if (owner.soft) return {-1, -1};
    const int element = owner.collision->element;
    const LinkTree& tree = scene.rigid[owner.body].model.articulation.tree;
    const int joint = tree.joints.empty() ? -1 : tree.jointOf[static_cast<std::size_t>(element)];
    return {element, joint < 0 ? -1 : tree.joints[static_cast<std::size_t>(joint)].parent};
}

} // namespace

void findPieces(const SoftModel& model, const CollisionModel& collision, std::vector<int>& pieceOf)
{
    if (model.pieces.empty() || !collision.own) return;
    const bool self = collision.shape->self;
    std::vector<int> ofNodes(model.rest.size(), -1);
    for (const BodyPiece& piece : model.pieces)
        for (int node : piece.nodes)
            ofNodes[static_cast<std::size_t>(node)] = self || piece.elements.empty() ? piece.number : -1;
    for (const geometry::Tetrahedron& nodes : collision.embedding.nodes)
        pieceOf.push_back(ofNodes[static_cast<std::size_t>(nodes[0])]);
}

// A body that has a model for each group of tools met itself in each of them once it was cut: the torn polyp of the
// hysteroscopy trainer three times, with three contacts at each place.
bool isSpared(const SoftModel& model, const CollisionModel& collision)
{
    return collision.own && !collision.shape->self &&
           std::ranges::any_of(model.collision, [&](const CollisionModel& each) {
               return &each != &collision && replaces(each, collision);
           });
}

std::vector<SurfaceOwner> surfaceOwners(const Scene& scene)
{
    std::vector<SurfaceOwner> owners;
    const auto add = [&](bool soft, std::size_t b, const auto& body, std::size_t firstElement) {
        for (int m = 0; const CollisionModel& each : body.collision) {
            const SurfaceName name{body.id, m++};
            if (soft && each.shape->cutting) continue; // this model is for blades only
            owners.push_back({soft, b, firstElement + static_cast<std::size_t>(each.element), name, &each});
        }
    };
    for (std::size_t b = 0; b < scene.soft.size(); ++b) add(true, b, scene.soft[b].model, 0);
    const std::vector<std::size_t> first = firstElements(scene);
    for (std::size_t b = 0; b < scene.rigid.size(); ++b) add(false, b, scene.rigid[b].model, first[b]);
    return owners;
}

bool isLine(const Scene& scene, const SurfaceOwner& owner) { return owner.soft && isRod(scene.soft[owner.body].model); }

const std::string& nameOf(const Scene& scene, const SurfaceOwner& owner)
{
    return owner.soft ? scene.soft[owner.body].model.name : scene.rigid[owner.body].model.name;
}

Vec3 valueAt(std::size_t vertex, const geometry::Embedding& embedding, const std::vector<Vec3>& values)
{
    Vec3 sum;
    for (std::size_t k = 0; k < 4; ++k)
        if (const double weight = embedding.weights[vertex][k]; weight != 0.0)
            sum += weight * values[static_cast<std::size_t>(embedding.nodes[vertex][k])];
    return sum;
}

double insetAt(const CollisionModel& collision, const Proximity& found, std::size_t side)
{
    double depth = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
        if (const int vertex = found.vertices[side][k]; vertex >= 0)
            depth += found.weights[side][k] * collision.inset.depth[static_cast<std::size_t>(vertex)];
    return depth;
}

std::vector<bool> placeSurfaces(const StepContext& context, const Scene& scene, const std::vector<SurfaceOwner>& owners,
                                Coupling& coupling)
{
    ContactDetection& detection = coupling.detection;
    warnOfTissueForBlades(scene, detection.warnedForBlades); // such tissue is no owner
    if (owners.size() != detection.surfaces.size()) {
        warnOfLoneGroups(scene, owners, detection.warnedGroups);
        warnOfThinProximity(scene, owners, detection.warnedThin);
        detection.idleBlades = warnOfIdleBlades(scene, detection.warnedIdle);
    }
    context.report.topology.idleBlades = detection.idleBlades;
    const bool same = std::ranges::equal(owners, detection.surfaces, {}, &SurfaceOwner::name, &CollisionSurface::name);
    std::vector<bool> added;
    for (std::size_t s = 0; !same && s < owners.size(); ++s)
        added.push_back(std::ranges::find(detection.surfaces, owners[s].name, &CollisionSurface::name) ==
                        detection.surfaces.end());
    detection.surfaces.resize(owners.size());
    for (std::size_t s = 0; s < owners.size(); ++s) {
        const SurfaceOwner& owner = owners[s];
        CollisionSurface& surface = detection.surfaces[s];
        surface.name = owner.name;
        std::tie(surface.element, surface.parent) = linkOf(owner, scene);
        surface.cuts = !owner.soft && owner.collision->shape->cutting &&
                       (scene.rigid[owner.body].state.cutting || scene.rigid[owner.body].state.sheath > 0);
        surface.cuttable = owner.soft && mayBeCut(scene.soft[owner.body].model, owner.collision->shape->group);
        placeSurface(context.dt, owner, scene, coupling.rigid, detection.normals, surface);
    }
    return added;
}

} // namespace filasofia::engine
