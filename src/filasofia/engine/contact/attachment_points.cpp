#include "filasofia/engine/contact/attachment_points.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/sorted.h"
#include "filasofia/engine/body/elements.h"
#include "filasofia/engine/collision/feature_normals.h"
#include "filasofia/engine/scene/find_body.h"
#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/distance.h"
#include "filasofia/physics/held_whole.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace filasofia::engine {
namespace {

using geometry::Box;

// If no region is given, a node is attached if it lies inside the other body, or this near to its surface, relative to
// the body's size.
constexpr double kNearby = 0.01;

/// A surface, for distance queries.
class NearSurface {
public:
    NearSurface(std::vector<Vec3> vertices, std::vector<geometry::Triangle> triangles)
    {
        surface_.shape = std::make_shared<const CollisionShape>(
            makeCollisionShape({.vertices = vertices, .triangles = std::move(triangles), .uv = {}}, {}));
        surface_.x = std::move(vertices);
        surface_.v.resize(surface_.x.size());
        boundSurface(surface_, 0.0);
        std::vector<Box> boxes;
        Box whole;
        for (const geometry::Triangle& t : surface_.shape->triangles) {
            Box box;
            for (int vertex : t) box = geometry::merged(box, at(vertex));
            whole = geometry::merged(geometry::merged(whole, box.low), box.high);
            boxes.push_back(box);
        }
        size_ = length(whole.high - whole.low);
        tree_ = geometry::Bvh(boxes);
    }

    [[nodiscard]] double size() const { return size_; }

    /// Whether the point is inside, or nearer than `within` [m].
    [[nodiscard]] bool has(Vec3 p, double within) const
    {
        const auto squaredDistance = [&](int t) {
            const geometry::Triangle& corners = surface_.shape->triangles[static_cast<std::size_t>(t)];
            return geometry::nearestOnTriangle(p, at(corners[0]), at(corners[1]), at(corners[2])).squaredDistance;
        };
        const double distance = std::sqrt(tree_.nearest(p, squaredDistance).value);
        if (distance <= within) return true;
        return surface_.shape->closed && geometry::squaredDistance(tree_.bounds(), p) == 0.0 &&
               inside(surface_, p, distance);
    }

private:
    [[nodiscard]] Vec3 at(int vertex) const { return surface_.x[static_cast<std::size_t>(vertex)]; }

    CollisionSurface surface_;
    geometry::Bvh tree_;
    double size_ = 0.0;
};

/// Per node, whether its piece still exists.
std::vector<char> nodesThere(const SoftModel& model)
{
    if (model.removed.empty()) return std::vector<char>(model.rest.size(), 1);
    std::vector<char> there(model.rest.size()); // a body that lost a piece lists all the others
    for (const BodyPiece& piece : model.pieces)
        for (int node : piece.nodes) there[static_cast<std::size_t>(node)] = 1;
    return there;
}

/// Each point as a weighted mean of the corners of the nearest triangle of a shell.
std::vector<AttachedPoint> onShell(const SoftModel& model, const SoftState& state, std::span<const Vec3> points)
{
    const auto at = [&](int node) { return state.x[static_cast<std::size_t>(node)]; };
    std::vector<Box> boxes;
    for (const auto& [a, b, c] : model.surface)
        boxes.push_back(geometry::merged(geometry::merged(Box{at(a), at(a)}, at(b)), at(c)));
    const geometry::Bvh tree(boxes);
    std::vector<AttachedPoint> found;
    for (Vec3 p : points) {
        const auto nearest = [&](int t) {
            const auto [a, b, c] = model.surface[static_cast<std::size_t>(t)];
            return geometry::nearestOnTriangle(p, at(a), at(b), at(c));
        };
        const int t = std::max(0, tree.nearest(p, [&](int each) { return nearest(each).squaredDistance; }).primitive);
        const auto weights = nearest(t).weights;
        AttachedPoint& point = found.emplace_back();
        for (std::size_t k = 0; k < 3; ++k)
            if (weights[k] > 0.0) point.nodes.push_back({model.surface[static_cast<std::size_t>(t)][k], weights[k]});
    }
    return found;
}

/// The place on a segment that is nearest to a point: a weight of its second end.
double nearestOn(Vec3 a, Vec3 b, Vec3 p)
{
    const Vec3 along = b - a;
    const double size = lengthSquared(along);
    return size > 0.0 ? std::clamp(dot(p - a, along) / size, 0.0, 1.0) : 0.0;
}

/// Each point as a weighted mean of the ends of the nearest edge of a rod that is left.
std::vector<AttachedPoint> onRod(const Rod& rod, std::span<const Vec3> x, std::span<const Vec3> points)
{
    std::vector<AttachedPoint> found;
    for (Vec3 p : points) {
        std::size_t best = 0;
        double weight = 0.0, nearest = std::numeric_limits<double>::infinity();
        for (std::size_t e = 0; e < rod.edges.size(); ++e) {
            if (isCut(rod, e)) continue;
            const Vec3 a = x[e], b = x[static_cast<std::size_t>(rod.edges[e].nodes[1])];
            const double t = nearestOn(a, b, p);
            const double far = lengthSquared(p - a - t * (b - a));
            if (!(far < nearest)) continue;
            nearest = far;
            best = e;
            weight = t;
        }
        AttachedPoint& point = found.emplace_back();
        const auto [first, second] = rod.edges[best].nodes;
        if (weight < 1.0) point.nodes.push_back({first, 1.0 - weight});
        if (weight > 0.0) point.nodes.push_back({second, weight});
    }
    return found;
}

/// Whether cuts have left an edge of a rod.
bool hasEdges(const Rod& rod) { return rod.cut.empty() || std::ranges::count(rod.cut, false) > 0; }

/// The current mesh without removed pieces.
geometry::TetMesh meshNow(const SoftModel& model, const SoftState& state)
{
    const std::vector<char> there = nodesThere(model);
    geometry::TetMesh mesh{state.x, {}};
    for (std::size_t e = 0; e < elementCount(model); ++e)
        if (const geometry::Tetrahedron& nodes = elementNodes(model, e); there[static_cast<std::size_t>(nodes[0])])
            mesh.tetrahedra.push_back(nodes);
    return mesh;
}

/// The nearest node to each point; the lowest index wins a tie.
std::vector<AttachedPoint> nearestNodes(const SoftModel& model, const SoftState& state, std::span<const Vec3> points)
{
    const std::vector<char> there = nodesThere(model);
    std::vector<int> nodes;
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
        if (!there[i]) continue;
        nodes.push_back(static_cast<int>(i));
        boxes.push_back({state.x[i], state.x[i]});
    }
    const geometry::Bvh tree(boxes);
    std::vector<AttachedPoint> found;
    for (Vec3 p : points) {
        const auto squaredDistance = [&](int k) { return lengthSquared(boxes[static_cast<std::size_t>(k)].low - p); };
        const int nearest = std::max(0, tree.nearest(p, squaredDistance).primitive);
        found.push_back({.nodes = {{nodes[static_cast<std::size_t>(nearest)], 1.0}}, .place = {}});
    }
    return found;
}

/// Each point as a weighted mean of the nodes around it. Weights that are zero but for rounding are dropped.
std::vector<AttachedPoint> embedded(const SoftModel& model, const SoftState& state, std::span<const Vec3> points)
{
    if (!model.shell.membranes.empty()) return onShell(model, state, points);
    if (isRod(model))
        return hasEdges(model.rod) ? onRod(model.rod, state.x, points) : nearestNodes(model, state, points);
    const geometry::Embedding embedding = geometry::embed(meshNow(model, state), points);
    std::vector<AttachedPoint> found(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        double sum = 0.0;
        for (std::size_t k = 0; k < 4; ++k) {
            const double weight = embedding.weights[i][k];
            if (std::abs(weight) < 1e-9) continue;
            found[i].nodes.push_back({embedding.nodes[i][k], weight});
            sum += weight;
        }
        for (NodeWeight& each : found[i].nodes) each.weight /= sum;
        const bool flat = std::ranges::any_of(found[i].nodes, [](NodeWeight w) { return !std::isfinite(w.weight); });
        if (flat || found[i].nodes.empty()) found[i] = nearestNodes(model, state, points.subspan(i, 1)).front();
    }
    return found;
}

Vec3 inElement(const Pose& pose, Vec3 place) { return transform(inverse(pose), place); }

const Pose& poseOf(const Scene& scene, std::size_t body, int element)
{
    return scene.rigid[body].state.poses[static_cast<std::size_t>(element)];
}

/// World positions as points of the body `to`, or of space.
std::vector<AttachedPoint> attachedTo(BodyId to, int element, physics::AttachMode mode, std::span<const Vec3> places,
                                      const Scene& scene)
{
    std::vector<AttachedPoint> points;
    const auto holder = findBody(scene, to);
    FILASOFIA_ASSERT(!to || holder);
    if (holder && holder->soft) {
        const SoftModel& body = scene.soft[holder->index].model;
        const SoftState& now = scene.soft[holder->index].state;
        return mode == physics::AttachMode::Nearest ? nearestNodes(body, now, places) : embedded(body, now, places);
    }
    for (Vec3 place : places) {
        AttachedPoint& point = points.emplace_back();
        point.element = element;
        point.place = holder ? inElement(poseOf(scene, holder->index, element), place) : place;
    }
    return points;
}

/// Adds the nodes that are near to, or inside, the other body.
void addNodesNear(const physics::AttachmentDef& def, std::span<const Vec3> x, const Scene& scene,
                  std::vector<int>& nodes)
{
    const auto holder = findBody(scene, def.to);
    const bool soft = holder->soft;
    if (soft && isRod(scene.soft[holder->index].model)) { // near its surface, a tube
        const std::vector<Vec3>& line = scene.soft[holder->index].state.x;
        const Rod& rod = scene.soft[holder->index].model.rod;
        const double radius = rod.radius, within = def.within.value_or(radius);
        for (std::size_t i = 0; i < x.size() && hasEdges(rod); ++i) {
            const std::vector<AttachedPoint> nearest = onRod(rod, line, x.subspan(i, 1));
            Vec3 place;
            for (const NodeWeight& each : nearest.front().nodes)
                place += each.weight * line[static_cast<std::size_t>(each.node)];
            if (distance(x[i], place) <= radius + within) nodes.push_back(static_cast<int>(i));
        }
        return;
    }
    const NearSurface near =
        soft ? NearSurface(scene.soft[holder->index].state.x, scene.soft[holder->index].model.surface)
             : NearSurface(scene.rigid[holder->index].model.surface->vertices,
                           scene.rigid[holder->index].model.surface->triangles);
    const double within = def.within.value_or(kNearby * near.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        const Vec3 p = soft ? x[i] : inElement(poseOf(scene, holder->index, def.element), x[i]);
        if (near.has(p, within)) nodes.push_back(static_cast<int>(i));
    }
}

double gyration(const RigidModel& model, int element)
{
    return physics::gyration(model.inertias[static_cast<std::size_t>(element)], model.surface.get());
}

/// The points by which an element is held as a whole. [m] in its coordinates.
std::vector<Vec3> pointsAround(const physics::RigidAttachmentDef& def, const RigidModel& body, const Scene& scene)
{
    double radius = body.dynamic ? gyration(body, def.element) : 0.0;
    if (const auto holder = findBody(scene, def.to); holder && radius == 0.0) {
        if (holder->soft) {
            const SoftModel& soft = scene.soft[holder->index].model;
            const std::vector<Vec3>& x = scene.soft[holder->index].state.x;
            Box box;
            for (const geometry::Tetrahedron& nodes : meshNow(soft, scene.soft[holder->index].state).tetrahedra)
                for (int node : nodes) box = geometry::merged(box, x[static_cast<std::size_t>(node)]);
            if (!soft.shell.membranes.empty() || isRod(soft)) box = geometry::boxAround(x);
            radius = 0.25 * length(box.high - box.low);
        } else {
            radius = gyration(scene.rigid[holder->index].model, def.toElement);
        }
    }
    FILASOFIA_ASSERT(radius > 0.0); // one of the two bodies is dynamic or soft
    return physics::pointsAround(body.inertias[static_cast<std::size_t>(def.element)].centre, radius);
}

AttachedPairs paired(std::vector<AttachedPoint> first, std::vector<AttachedPoint> second)
{
    AttachedPairs pairs;
    for (std::size_t i = 0; i < first.size(); ++i) pairs.push_back({std::move(first[i]), std::move(second[i])});
    return pairs;
}

/// Several nodes that are drawn to one would make the elements between them flat, and turn them inside out: only the
/// nearest of them keeps its pair. The first wins a tie.
void keepNearest(std::span<const Vec3> x, std::span<const Vec3> toX, AttachedPairs& pairs)
{
    std::map<int, std::pair<double, int>> nearest; // per node that others are drawn to
    const auto places = [](const std::array<AttachedPoint, 2>& pair) {
        return std::array{pair[0].nodes.front().node, pair[1].nodes.front().node};
    };
    for (const auto& pair : pairs) {
        const auto [node, other] = places(pair);
        const double squared = lengthSquared(x[static_cast<std::size_t>(node)] - toX[static_cast<std::size_t>(other)]);
        const auto [at, isNew] = nearest.try_emplace(other, squared, node);
        if (!isNew) at->second = std::min(at->second, std::pair(squared, node));
    }
    std::erase_if(pairs, [&](const auto& pair) {
        const auto [node, other] = places(pair);
        return nearest.at(other).second != node;
    });
}

/// Pairs of nodes, without those of removed pieces.
AttachedPairs nodePairsOf(const physics::AttachmentDef& def, std::size_t body, const Scene& scene)
{
    const std::vector<char> there = nodesThere(scene.soft[body].model);
    const std::vector<char> toThere = nodesThere(scene.soft[findBody(scene, def.to)->index].model);
    std::vector<std::pair<int, int>> numbers;
    for (std::size_t i = 0; i < def.nodes.size(); ++i) {
        const int node = def.nodes[i], other = def.toNodes[i];
        if (there[static_cast<std::size_t>(node)] && toThere[static_cast<std::size_t>(other)])
            numbers.emplace_back(node, other);
    }
    sortUnique(numbers);
    AttachedPairs pairs;
    for (const auto& [node, other] : numbers)
        pairs.push_back({{{.nodes = {{node, 1.0}}, .place = {}}, {.nodes = {{other, 1.0}}, .place = {}}}});
    return pairs;
}

} // namespace

BodyPoint softPoint(const std::vector<NodeWeight>& nodes, std::size_t body, const SoftState& state)
{
    BodyPoint point;
    writeSoftPoint(nodes, body, state, point);
    return point;
}

void writeSoftPoint(const std::vector<NodeWeight>& nodes, std::size_t body, const SoftState& state, BodyPoint& out)
{
    out.of = BodyPoint::Of::Soft;
    out.body = body;
    for (const NodeWeight& each : nodes) out.add(each.node, each.weight);
    out.position = meanOf(nodes, state.x);
    out.velocity = meanOf(nodes, state.v);
}

std::vector<NodeWeight> nodeWeights(const BodyPoint& point)
{
    std::vector<NodeWeight> nodes;
    for (std::size_t k = 0; k < static_cast<std::size_t>(point.count); ++k)
        nodes.push_back({point.nodes[k], point.weights[k]});
    return nodes;
}

std::vector<int> nodesOf(const physics::AttachmentDef& def, std::span<const Vec3> x)
{
    std::vector<int> nodes = def.nodes;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const bool inBox = def.box && geometry::merged(*def.box, x[i]) == *def.box;
        const bool inBall = def.ball && length(x[i] - def.ball->centre) <= def.ball->radius;
        if (inBox || inBall) nodes.push_back(static_cast<int>(i));
    }
    sortUnique(nodes);
    return nodes;
}

AttachedPairs pairsOf(const physics::AttachmentDef& def, std::size_t body, const Scene& scene)
{
    if (!def.toNodes.empty()) return nodePairsOf(def, body, scene);
    const std::vector<Vec3>& x = scene.soft[body].state.x;
    std::vector<int> nodes = nodesOf(def, x);
    if (def.within || (def.nodes.empty() && !def.box && !def.ball)) {
        addNodesNear(def, x, scene, nodes);
        sortUnique(nodes);
    }
    const std::vector<char> there = nodesThere(scene.soft[body].model);
    std::erase_if(nodes, [&](int node) { return !there[static_cast<std::size_t>(node)]; });
    std::vector<AttachedPoint> held;
    std::vector<Vec3> places;
    for (int node : nodes) {
        held.push_back({.nodes = {{node, 1.0}}, .place = {}});
        places.push_back(x[static_cast<std::size_t>(node)]);
    }
    AttachedPairs pairs = paired(std::move(held), attachedTo(def.to, def.element, def.mode, places, scene));
    const auto holder = findBody(scene, def.to);
    if (def.mode == physics::AttachMode::Nearest && holder && holder->soft)
        keepNearest(x, scene.soft[holder->index].state.x, pairs);
    return pairs;
}

AttachedPairs pairsOf(const physics::RigidAttachmentDef& def, std::size_t body, const Scene& scene)
{
    const RigidModel& rigid = scene.rigid[body].model;
    std::vector<AttachedPoint> held;
    std::vector<Vec3> places;
    for (Vec3 point : def.points.empty() ? pointsAround(def, rigid, scene) : def.points) {
        held.push_back({.nodes = {}, .element = def.element, .place = point});
        places.push_back(transform(poseOf(scene, body, def.element), point));
    }
    return paired(std::move(held), attachedTo(def.to, def.toElement, physics::AttachMode::Barycentric, places, scene));
}

} // namespace filasofia::engine
