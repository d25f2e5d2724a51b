#include "filasofia/engine/body/check_collision.h"
#include "filasofia/core/error.h"
#include "filasofia/engine/body/check_size.h"
#include "filasofia/engine/body/usable.h"

#include <algorithm>
#include <cmath>

namespace filasofia::engine {
namespace {

void checkIndices(const std::string& object, const char* list, std::span<const int> indices, std::size_t count,
                  int minimum = 0)
{
    for (const int each : indices)
        if (each < minimum || each >= static_cast<int>(count))
            fail(object, ": ", list, " must be in [", minimum, ", ", count, "), got ", each);
}

void checkUsable(const std::string& object, const char* list, std::span<const Vec3> values)
{
    if (!usable(values))
        fail(object, ": ", list, " must be finite and within ", physics::kFarthest, " m of the origin");
}

void checkRows(const std::string& object, const char* list, const geometry::CompressedRows& rows, std::size_t count,
               std::size_t items)
{
    checkSize(object, list, rows.start.size(), count + 1);
    if (rows.start.front() != 0 || !std::ranges::is_sorted(rows.start) ||
        static_cast<std::size_t>(rows.start.back()) != rows.items.size())
        fail(object, ": ", list, " must hold consecutive rows");
    checkIndices(object, list, rows.items, items);
}

/// Children come after their parent and leaves hold elements, so that every traversal ends and stays within the lists.
void checkTree(const std::string& object, const CollisionShape& shape)
{
    for (const CollisionShape::Element& element : shape.elements) {
        checkIndices(object, "an element's vertices", element.vertices, shape.rest.size(), -1);
        if (element.vertices[0] < 0) fail(object, ": an element must have a vertex");
        checkIndices(object, "an element's ownVertices", element.ownVertices, shape.rest.size(), -1);
        checkIndices(object, "an element's ownEdges", element.ownEdges, shape.edges.size(), -1);
        checkIndices(object, "an element's triangle", {&element.triangle, 1}, shape.triangles.size(), -1);
    }
    if (shape.nodes.empty() != shape.elements.empty())
        fail(object, ": nodes must be empty if, and only if, elements is");
    const auto count = static_cast<std::int64_t>(shape.nodes.size());
    for (std::int64_t n = 0; n < count; ++n) {
        const CollisionShape::Node& node = shape.nodes[static_cast<std::size_t>(n)];
        const std::int64_t end = std::int64_t{node.first} + node.count;
        const bool leaf = node.count > 0 && node.first >= 0 && end <= static_cast<std::int64_t>(shape.elements.size());
        const bool fork = node.count == 0 && node.first > n + 1 && node.first < count;
        if (!leaf && !fork) fail(object, ": nodes[", n, "] must be a leaf of elements or have two children after it");
    }
}

void checkShape(const std::string& object, const CollisionShape& shape)
{
    if (shape.rest.size() + shape.edges.size() + shape.triangles.size() >= kMaxFeatures)
        fail(object, ": must have < ", kMaxFeatures, " vertices, edges and triangles");
    checkUsable(object, "rest", shape.rest);
    for (const auto& triangle : shape.triangles) checkIndices(object, "triangles", triangle, shape.rest.size());
    for (const auto& edge : shape.edges) checkIndices(object, "edges", edge, shape.rest.size());
    checkRows(object, "edgeTriangles", shape.edgeTriangles, shape.edges.size(), shape.triangles.size());
    checkSize(object, "edgeOpposites", shape.edgeOpposites.size(), shape.edgeTriangles.items.size());
    checkIndices(object, "edgeOpposites", shape.edgeOpposites, shape.rest.size());
    checkRows(object, "vertexEdges", shape.vertexEdges, shape.rest.size(), shape.edges.size());
    checkRows(object, "vertexTriangles", shape.vertexTriangles, shape.rest.size(), shape.triangles.size());
    if (!nonNegative().contains(shape.proximity) || !(shape.depth >= shape.proximity && shape.depth < 1e9))
        fail(object, ": proximity and depth must be finite, 0 <= proximity <= depth");
    checkTree(object, shape);
}

/// Checks shape, inset and proximity, which soft and rigid bodies have in common.
const CollisionShape& checkSurface(const std::string& object, const CollisionModel& model)
{
    if (!model.shape) fail(object, ": must have a shape");
    const CollisionShape& shape = *model.shape;
    checkShape(object + ".shape", shape);
    checkSize(object, "inset.depth", model.inset.depth.size(), shape.rest.size());
    checkSize(object, "inset.share", model.inset.share.size(), shape.vertexTriangles.items.size());
    for (const double depth : model.inset.depth)
        if (!nonNegative().contains(depth)) fail(object, ": inset.depth must be >= 0 m, got ", depth);
    for (const double share : model.inset.share)
        if (!std::isfinite(share)) fail(object, ": inset.share must be finite");
    if (!nonNegative().contains(model.proximity))
        fail(object, ": proximity must be finite and >= 0 m, got ", model.proximity);
    return shape;
}

void checkCount(const std::string& object, std::size_t count)
{
    if (count > kMaxModels) fail(object, ": collision must have <= ", kMaxModels, " entries, got ", count);
}

} // namespace

void checkCollision(const std::string& object, const SoftModel& body)
{
    checkCount(object, body.collision.size());
    for (std::size_t m = 0; m < body.collision.size(); ++m) {
        const CollisionModel& model = body.collision[m];
        const std::string field = text(object, ": collision[", m, "]");
        const CollisionShape& shape = checkSurface(field, model);
        checkSize(field, "embedding.nodes", model.embedding.nodes.size(), shape.rest.size());
        checkSize(field, "embedding.weights", model.embedding.weights.size(), shape.rest.size());
        for (std::size_t v = 0; v < shape.rest.size(); ++v) {
            checkIndices(field, "embedding.nodes", model.embedding.nodes[v], body.rest.size());
            for (const double weight : model.embedding.weights[v])
                if (!std::isfinite(weight)) fail(field, ": embedding.weights must be finite");
        }
        if (model.behind.empty()) continue;
        checkSize(field, "behind", model.behind.size(), shape.triangles.size());
        checkIndices(field, "behind", model.behind, body.rest.size());
    }
}

void checkCollision(const std::string& object, const RigidModel& body)
{
    checkCount(object, body.collision.size());
    for (std::size_t m = 0; m < body.collision.size(); ++m) {
        const CollisionModel& model = body.collision[m];
        const std::string field = text(object, ": collision[", m, "]");
        const CollisionShape& shape = checkSurface(field, model);
        checkSize(field, "core", model.core.size(), shape.rest.size());
        checkUsable(field, "core", model.core);
        checkIndices(field, "element", {&model.element, 1}, body.rest.size());
    }
}

} // namespace filasofia::engine
