#include "filasofia/engine/body/collision_model.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/geometry/capsule_of.h"
#include "filasofia/geometry/mass_properties.h"
#include "filasofia/geometry/surface.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

namespace filasofia::engine {
namespace {

using geometry::TriangleMesh;

// [-] The largest depth of the inset over the proximity.
constexpr double kInset = 0.2;
// [-] A solid's largest proximity to itself over its mean edge. In a vessel of 2,112 triangles with edges of 0.6 mm
// that was cut through, every triangle was within the proximity of 53 others: contacts took 30 ms a step.
constexpr double kOwnProximity = 0.25;

double ownProximityOf(const CollisionShape& shape, double proximity)
{
    if (!shape.closed || shape.edges.empty()) return proximity;
    double sum = 0.0;
    for (const auto& [a, b] : shape.edges) sum += distance(shape.rest[a], shape.rest[b]);
    return std::min(proximity, kOwnProximity * sum / static_cast<double>(shape.edges.size()));
}

/// `how`: its partners, and whether it is rigid; the rest follows from the Def. `round` [m]: half the thickness of a
/// shell, whose triangles are its middle.
CollisionModel modelOf(const TriangleMesh& mesh, const physics::CollisionDef& def, const std::string& field,
                       const CollisionOptions& how = {}, double round = 0.0)
{
    if (const std::size_t features = mesh.vertices.size() + 4 * mesh.triangles.size(); features >= kMaxFeatures)
        fail(field, ".mesh must have < ", kMaxFeatures, " vertices, edges and triangles, got up to ", features);
    const double depth = round > 0.0 ? round : insetDepth(def.proximity);
    CollisionModel model;
    model.round = round;
    CollisionShape shape = makeCollisionShape(mesh, {.points = def.primitives.points,
                                                     .lines = def.primitives.lines,
                                                     .triangleFaces = def.primitives.triangles,
                                                     .proximity = def.proximity,
                                                     .depth = def.proximity + depth,
                                                     .partners = how.partners,
                                                     .sheet = round > 0.0,
                                                     .group = def.group,
                                                     .self = def.self,
                                                     .cutting = def.cutting,
                                                     .rigid = how.rigid});
    model.inset = round > 0.0 ? roundInset(shape, round) : makeInset(shape, depth);
    model.proximity = def.proximity;
    model.ownProximity = ownProximityOf(shape, def.proximity);
    setProximity(model, shape);
    model.shape = std::make_shared<const CollisionShape>(std::move(shape));
    model.selfOnceCut = def.selfOnceCut.value_or(true);
    return model;
}

/// All that is within `radius` of points and the segments between them.
CollisionModel aroundLines(const std::vector<Vec3>& rest, double radius, CollisionOptions options)
{
    options.triangleFaces = false;
    options.depth = options.proximity + radius;
    CollisionShape shape = makeCollisionShape({.vertices = rest, .triangles = {}, .uv = {}}, options);
    CollisionModel model;
    model.proximity = model.ownProximity = options.proximity;
    model.round = radius;
    model.inset = roundInset(shape, radius);
    setProximity(model, shape);
    model.shape = std::make_shared<const CollisionShape>(std::move(shape));
    return model;
}

/// The ball or capsule that a rigid body's mesh stands for, if it is one: for what is rigid.
std::optional<CollisionModel> exactModelOf(const TriangleMesh& mesh, const physics::CollisionDef& def)
{
    const bool all = def.primitives.points && def.primitives.lines && def.primitives.triangles;
    const auto exact = all && !def.cutting ? geometry::capsuleOf(mesh) : std::nullopt;
    if (!exact) return {};
    CollisionOptions options{
        .proximity = def.proximity, .partners = Partners::Rigid, .group = def.group, .self = def.self};
    std::vector<Vec3> ends{exact->ends[0]};
    if (exact->ends[1] != exact->ends[0]) {
        ends.push_back(exact->ends[1]);
        options.segments = {{0, 1}};
    }
    CollisionModel model = aroundLines(ends, exact->radius, std::move(options));
    model.core = std::move(ends);
    model.element = def.element;
    return model;
}

/// The nodes of a rod laid out along a line, or a ring's around a circle. What is near along the rod does not collide,
/// however the rod lies at the start: a knot whose turns already touch is as tight as one that was pulled.
std::vector<Vec3> laidOut(const std::vector<Vec3>& nodes, bool closed)
{
    std::vector<double> along(1, 0.0);
    for (std::size_t i = 1; i < nodes.size(); ++i) along.push_back(along.back() + distance(nodes[i - 1], nodes[i]));
    const double whole = along.back() + distance(nodes.back(), nodes.front());
    std::vector<Vec3> out;
    for (const double s : along) {
        const double angle = 2.0 * std::numbers::pi * s / whole, radius = 0.5 * whole / std::numbers::pi;
        out.push_back(closed ? Vec3{radius * std::cos(angle), radius * std::sin(angle), 0.0} : Vec3{s, 0.0, 0.0});
    }
    return out;
}

/// The embedding of vertices that coincide with nodes.
geometry::Embedding nodeEmbedding(const std::vector<int>& nodes)
{
    geometry::Embedding embedding;
    addToEmbedding(nodes, embedding);
    return embedding;
}

/// Per triangle of the surface: the node of its tetrahedron that is not on it.
std::vector<int> nodesBehind(const geometry::TetMesh& mesh, const geometry::Surface& surface)
{
    std::map<std::array<int, 3>, int> behind; // key: the nodes, ascending
    for (const geometry::Tetrahedron& t : mesh.tetrahedra)
        for (std::size_t opposite = 0; opposite < 4; ++opposite) {
            std::array<int, 3> face{};
            for (std::size_t k = 0; k < 3; ++k)
                face[k] = t[static_cast<std::size_t>(geometry::kTetrahedronFaces[opposite][k])];
            std::sort(face.begin(), face.end());
            behind[face] = t[opposite];
        }
    std::vector<int> nodes;
    for (geometry::Triangle t : surface.mesh.triangles) {
        for (int& vertex : t) vertex = surface.nodes[static_cast<std::size_t>(vertex)];
        std::sort(t.begin(), t.end());
        nodes.push_back(behind.at(t));
    }
    return nodes;
}

/// Removes weights that differ from zero by rounding only, so that a vertex at a node follows that node alone.
void dropTinyWeights(geometry::Embedding& embedding)
{
    for (std::array<double, 4>& weights : embedding.weights) {
        double sum = 0.0;
        for (double& weight : weights) sum += weight = std::abs(weight) < 1e-9 ? 0.0 : weight;
        for (double& weight : weights) weight /= sum;
    }
}

void checkCount(const std::vector<physics::CollisionDef>& collision, const std::string& object)
{
    if (collision.size() > kMaxModels)
        fail(object, ": collision must have <= ", kMaxModels, " entries, got ", collision.size());
}

void checkPrimitives(const physics::CollisionDef& def, const std::string& field)
{
    const physics::Primitives& p = def.primitives;
    if (!p.points && !p.lines && !p.triangles)
        fail(field, ".primitives must have points, lines or triangles, got none");
}

} // namespace

double insetDepth(double proximity) { return kInset * proximity; }

void setProximity(const CollisionModel& model, CollisionShape& shape)
{
    double deepest = 0.0;
    for (const double each : model.inset.depth) deepest = std::max(deepest, each);
    shape.proximity = model.proximity + deepest;
    shape.ownProximity = model.ownProximity + deepest;
}

void addToEmbedding(std::span<const int> nodes, geometry::Embedding& embedding)
{
    for (int node : nodes) {
        embedding.nodes.push_back({node, node, node, node});
        embedding.weights.push_back({1.0, 0.0, 0.0, 0.0});
    }
}

std::vector<CollisionModel> buildCollision(const physics::SoftBodyDef& def, const geometry::TetMesh& worldMesh)
{
    checkCount(def.collision, text("soft body '", def.name, "'"));
    std::vector<CollisionModel> models;
    for (std::size_t i = 0; i < def.collision.size(); ++i) {
        const physics::CollisionDef& each = def.collision[i];
        const std::string field = text("soft body '", def.name, "': collision[", i, "]");
        checkPrimitives(each, field);
        if (const auto given = physics::loadMesh(each.mesh, field + ".mesh")) {
            if (def.dynamicTopology)
                logWarning(field, ".mesh: deforms with the body but does not open if the body is cut or torn; without "
                                  "a mesh the body's own surface is used, which does");
            TriangleMesh mesh = *given;
            for (Vec3& vertex : mesh.vertices) vertex = transform(def.pose, vertex);
            models.push_back(modelOf(mesh, each, field));
            models.back().embedding = geometry::embed(worldMesh, mesh.vertices);
            dropTinyWeights(models.back().embedding);
        } else {
            const geometry::Surface surface = geometry::extractSurface(worldMesh);
            models.push_back(modelOf(surface.mesh, each, field));
            models.back().embedding = nodeEmbedding(surface.nodes);
            models.back().behind = nodesBehind(worldMesh, surface);
            models.back().own = true;
        }
    }
    return models;
}

std::vector<CollisionModel> buildCollision(const physics::SoftBodyDef& def, const TriangleMesh& worldShell)
{
    checkCount(def.collision, text("soft body '", def.name, "'"));
    const double halfThickness = 0.5 * std::get<physics::ShellMaterial>(def.material).thickness;
    std::vector<int> nodes(worldShell.vertices.size());
    std::iota(nodes.begin(), nodes.end(), 0);
    std::vector<CollisionModel> models;
    for (std::size_t i = 0; i < def.collision.size(); ++i) {
        const std::string field = text("soft body '", def.name, "': collision[", i, "]");
        checkPrimitives(def.collision[i], field);
        models.push_back(modelOf(worldShell, def.collision[i], field, {}, halfThickness));
        models.back().embedding = nodeEmbedding(nodes);
        models.back().own = true;
    }
    return models;
}

std::vector<CollisionModel> buildCollision(const physics::RodBodyDef& def, const std::vector<Vec3>& nodes)
{
    if (!def.collision) return {};
    const double proximity = def.collision->proximity.value_or(def.radius);
    CollisionOptions options{.proximity = proximity, .group = def.collision->group, .self = def.collision->self};
    for (int i = 0; i + 1 < static_cast<int>(nodes.size()); ++i) options.segments.push_back({i, i + 1});
    if (def.closed) options.segments.push_back({0, static_cast<int>(nodes.size()) - 1});
    CollisionModel model = aroundLines(laidOut(nodes, def.closed), def.radius, std::move(options));
    std::vector<int> all(nodes.size());
    std::iota(all.begin(), all.end(), 0);
    model.embedding = nodeEmbedding(all);
    return {std::move(model)};
}

CollisionModel cutCollision(const CollisionModel& whole, std::vector<std::array<int, 2>> segments,
                            std::vector<int> lone)
{
    CollisionModel model = whole;
    CollisionShape shape =
        makeCollisionShape({.vertices = whole.shape->rest, .triangles = {}, .uv = {}}, {.triangleFaces = false,
                                                                                        .segments = std::move(segments),
                                                                                        .lone = std::move(lone),
                                                                                        .proximity = whole.proximity,
                                                                                        .depth = whole.shape->depth,
                                                                                        .group = whole.shape->group,
                                                                                        .self = whole.shape->self});
    setProximity(model, shape);
    model.shape = std::make_shared<const CollisionShape>(std::move(shape));
    return model;
}

std::vector<CollisionModel> buildCollision(const physics::RigidBodyDef& def)
{
    checkCount(def.collision, text("rigid body '", def.name, "'"));
    std::vector<CollisionModel> models, exacts;
    for (std::size_t i = 0; i < def.collision.size(); ++i) {
        const physics::CollisionDef& each = def.collision[i];
        const std::string field = text("rigid body '", def.name, "': collision[", i, "]");
        checkPrimitives(each, field);
        auto mesh = physics::loadMesh(each.mesh, field + ".mesh");
        if (!mesh) mesh = physics::loadMesh(def.mesh, text("rigid body '", def.name, "': mesh"));
        if (!mesh) fail(field, ".mesh must name a file or be a mesh: the body has none either");
        CollisionModel& model = models.emplace_back(modelOf(*mesh, each, field, {.rigid = true}));
        auto exact = model.shape->closed ? exactModelOf(*mesh, each) : std::nullopt;
        if (exact) model = modelOf(*mesh, each, field, {.partners = Partners::Soft, .rigid = true});
        model.element = each.element;
        model.core = mesh->vertices;
        if (exact) exacts.push_back(std::move(*exact));
        // A dynamic body has been refused by now: its mass would not be positive.
        if (model.shape->closed && !def.dynamic && !each.cutting && geometry::enclosedVolume(*mesh) < 0.0)
            logWarning(field, ".mesh is turned inside out: it pushes towards its inside, like the walls of a room; "
                              "triangles must be counter-clockwise seen from the side where other bodies are");
        std::vector<Vec3> normals;
        applyInset(*model.shape, model.inset, normals, model.core);
    }
    std::ranges::move(exacts, std::back_inserter(models));
    return models;
}

} // namespace filasofia::engine
