#include "filasofia/engine/collision/collision_shape.h"

#include "filasofia/core/assert.h"
#include "filasofia/geometry/box.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

namespace filasofia::engine {
namespace {

constexpr int kLeafSize = 4;

std::array<int, 2> ordered(int a, int b) { return a < b ? std::array{a, b} : std::array{b, a}; }

int edgeNumber(const CollisionShape& shape, std::array<int, 2> edge)
{
    return static_cast<int>(std::ranges::lower_bound(shape.edges, edge) - shape.edges.begin());
}

void collectEdges(const std::vector<std::array<int, 2>>& segments, CollisionShape& shape)
{
    for (const geometry::Triangle& t : shape.triangles)
        for (int k = 0; k < 3; ++k) shape.edges.push_back(ordered(t[k], t[(k + 1) % 3]));
    for (const auto& [a, b] : segments) {
        const int count = static_cast<int>(shape.rest.size());
        FILASOFIA_ASSERT(a >= 0 && b >= 0 && a < count && b < count && a != b);
        shape.edges.push_back(ordered(a, b));
    }
    std::ranges::sort(shape.edges);
    shape.edges.erase(std::unique(shape.edges.begin(), shape.edges.end()), shape.edges.end());
}

// The rows of a relation given as (row, item) pairs.
geometry::CompressedRows rowsOf(std::vector<std::array<int, 2>>& pairs, std::size_t rows)
{
    std::ranges::sort(pairs);
    geometry::CompressedRows out;
    out.start.assign(rows + 1, 0);
    for (const auto& pair : pairs) {
        ++out.start[static_cast<std::size_t>(pair[0]) + 1];
        out.items.push_back(pair[1]);
    }
    std::partial_sum(out.start.begin(), out.start.end(), out.start.begin());
    return out;
}

void connect(CollisionShape& shape)
{
    std::vector<std::array<int, 2>> ofEdge, ofVertex, edgesOfVertex;
    std::vector<int> walked(shape.edges.size(), 0);
    for (int t = 0; t < static_cast<int>(shape.triangles.size()); ++t)
        for (int k = 0; k < 3; ++k) {
            const int a = shape.triangles[t][k], b = shape.triangles[t][(k + 1) % 3];
            const int edge = edgeNumber(shape, ordered(a, b));
            ofEdge.push_back({edge, t});
            ofVertex.push_back({a, t});
            walked[edge] += a < b ? 1 : -1;
        }
    for (int e = 0; e < static_cast<int>(shape.edges.size()); ++e)
        for (const int vertex : shape.edges[e]) edgesOfVertex.push_back({vertex, e});
    shape.edgeTriangles = rowsOf(ofEdge, shape.edges.size());
    shape.vertexTriangles = rowsOf(ofVertex, shape.rest.size());
    shape.vertexEdges = rowsOf(edgesOfVertex, shape.rest.size());
    shape.closed = !shape.triangles.empty() && std::ranges::all_of(walked, [](int count) { return count == 0; });
    for (const auto& [edge, triangle] : ofEdge) {
        const auto [a, b, c] = shape.triangles[triangle];
        shape.edgeOpposites.push_back(a + b + c - shape.edges[edge][0] - shape.edges[edge][1]);
    }
}

void collectElements(CollisionShape& shape)
{
    for (int t = 0; t < static_cast<int>(shape.triangles.size()); ++t)
        shape.elements.push_back({.vertices = shape.triangles[t], .triangle = t});
    for (int e = 0; e < static_cast<int>(shape.edges.size()); ++e)
        if (shape.edgeTriangles[e].empty())
            shape.elements.push_back({.vertices = {shape.edges[e][0], shape.edges[e][1], -1}});
    if (!shape.elements.empty()) return;
    for (int v = 0; v < static_cast<int>(shape.rest.size()); ++v) shape.elements.push_back({.vertices = {v, -1, -1}});
}

// Halves the elements at the median of their middles, as geometry::Bvh does, but into whole leaves: fewer nodes.
int plant(const std::vector<Vec3>& middles, std::span<int> order, int first, std::vector<CollisionShape::Node>& nodes)
{
    const int self = static_cast<int>(nodes.size()), count = static_cast<int>(order.size());
    nodes.push_back({first, count});
    if (count <= kLeafSize) return std::ranges::sort(order), self;
    geometry::Box box;
    for (const int i : order) box = merged(box, middles[i]);
    const Vec3 spread = box.high - box.low;
    const int axis = spread.x >= spread.y && spread.x >= spread.z ? 0 : spread.y >= spread.z ? 1 : 2;
    const auto before = [&](int a, int b) {
        return middles[a][axis] != middles[b][axis] ? middles[a][axis] < middles[b][axis] : a < b;
    };
    const int half = (count / 2 + kLeafSize - 1) / kLeafSize * kLeafSize;
    std::nth_element(order.begin(), order.begin() + half, order.end(), before);
    plant(middles, order.first(static_cast<std::size_t>(half)), first, nodes);
    const int right = plant(middles, order.subspan(static_cast<std::size_t>(half)), first + half, nodes);
    nodes[self] = {right, 0};
    return self;
}

void plantTree(CollisionShape& shape)
{
    if (shape.elements.empty()) return;
    std::vector<Vec3> middles;
    for (const CollisionShape::Element& element : shape.elements) {
        geometry::Box box;
        for (const int v : element.vertices)
            if (v >= 0) box = merged(box, shape.rest[v]);
        middles.push_back(0.5 * (box.low + box.high));
    }
    std::vector<int> order(shape.elements.size());
    std::iota(order.begin(), order.end(), 0);
    plant(middles, order, 0, shape.nodes);
    std::vector<CollisionShape::Element> inOrder;
    for (const int i : order) inOrder.push_back(shape.elements[i]);
    shape.elements = std::move(inOrder);
}

void shareOut(CollisionShape& shape)
{
    std::vector<bool> vertexTaken(shape.rest.size()), edgeTaken(shape.edges.size());
    for (CollisionShape::Element& element : shape.elements)
        for (int k = 0; k < 3; ++k) {
            const int a = element.vertices[k], b = element.vertices[(k + 1) % 3];
            if (a >= 0 && !vertexTaken[a]) vertexTaken[a] = true, element.ownVertices[k] = a;
            if (a < 0 || b < 0) continue;
            const int edge = edgeNumber(shape, ordered(a, b));
            if (edge < static_cast<int>(shape.edges.size()) && !edgeTaken[edge])
                edgeTaken[edge] = true, element.ownEdges[k] = edge;
        }
}

} // namespace

CollisionShape makeCollisionShape(const geometry::TriangleMesh& mesh, const CollisionOptions& options)
{
    FILASOFIA_ASSERT(options.proximity >= 0.0 && options.depth >= 0.0);
    CollisionShape shape;
    shape.rest = mesh.vertices;
    shape.triangles = mesh.triangles;
    shape.points = options.points;
    shape.lines = options.lines;
    shape.triangleFaces = options.triangleFaces && !mesh.triangles.empty();
    shape.proximity = options.proximity;
    shape.depth = std::max(options.depth, options.proximity);
    shape.group = options.group;
    shape.self = options.self;
    shape.cutting = options.cutting;
    collectEdges(options.segments, shape);
    connect(shape);
    collectElements(shape);
    plantTree(shape);
    shareOut(shape);
    shape.lines = shape.lines && !shape.edges.empty();
    return shape;
}

} // namespace filasofia::engine
