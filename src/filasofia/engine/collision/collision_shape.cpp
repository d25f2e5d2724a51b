#include "filasofia/engine/collision/collision_shape.h"

#include "filasofia/core/assert.h"
#include "filasofia/engine/collision/shape_parts.h"
#include "filasofia/geometry/box.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

namespace filasofia::engine {
namespace {

constexpr int kLeafSize = 4;

/// All uses of edges, ascending. They are counting-sorted by their lower vertex, and compared only within one vertex.
std::vector<EdgeUse> edgeUses(const CollisionShape& shape, const std::vector<std::array<int, 2>>& segments)
{
    const int count = static_cast<int>(shape.rest.size());
    for (const auto& [a, b] : segments) FILASOFIA_ASSERT(a >= 0 && b >= 0 && a < count && b < count && a != b);
    const auto forEach = [&](const auto& visit) {
        for (const auto& [a, b] : segments) visit(EdgeUse{ordered(a, b)});
        for (int t = 0; t < static_cast<int>(shape.triangles.size()); ++t)
            for (int k = 0; k < 3; ++k)
                visit(EdgeUse{ordered(shape.triangles[t][k], shape.triangles[t][(k + 1) % 3]), t});
    };
    std::vector<int> start(shape.rest.size() + 1, 0);
    forEach([&](const EdgeUse& use) { ++start[use.edge[0] + 1]; });
    std::partial_sum(start.begin(), start.end(), start.begin());
    std::vector<EdgeUse> uses(static_cast<std::size_t>(start.back()));
    std::vector<int> next(start.begin(), start.end() - 1);
    forEach([&](const EdgeUse& use) { uses[static_cast<std::size_t>(next[use.edge[0]]++)] = use; });
    for (int v = 0; v < count; ++v) std::sort(uses.begin() + start[v], uses.begin() + start[v + 1]);
    return uses;
}

/// Builds rows from `forEach`, which calls (row, item) in ascending order of items, twice in the same order.
template <class ForEach> geometry::CompressedRows rowsOf(std::size_t rows, const ForEach& forEach)
{
    geometry::CompressedRows out;
    out.start.assign(rows + 1, 0);
    forEach([&](int row, int) { ++out.start[row + 1]; });
    std::partial_sum(out.start.begin(), out.start.end(), out.start.begin());
    out.items.resize(static_cast<std::size_t>(out.start.back()));
    std::vector<int> next(out.start.begin(), out.start.end() - 1);
    forEach([&](int row, int item) { out.items[static_cast<std::size_t>(next[row]++)] = item; });
    return out;
}

void collectElements(CollisionShape& shape)
{
    for (int t = 0; t < static_cast<int>(shape.triangles.size()); ++t)
        shape.elements.push_back({.vertices = shape.triangles[t], .triangle = t});
    for (int e = 0; e < static_cast<int>(shape.edges.size()); ++e)
        if (shape.edgeTriangles[e].empty())
            shape.elements.push_back({.vertices = {shape.edges[e][0], shape.edges[e][1], -1}});
    for (const int v : shape.lone) shape.elements.push_back({.vertices = {v, -1, -1}});
    if (!shape.elements.empty()) return;
    for (int v = 0; v < static_cast<int>(shape.rest.size()); ++v) shape.elements.push_back({.vertices = {v, -1, -1}});
}

/// Per triangle, the indices of its three sides' edges.
std::vector<std::array<int, 3>> sidesOf(const CollisionShape& shape)
{
    std::vector<std::array<int, 3>> sides(shape.triangles.size());
    for (int e = 0; e < static_cast<int>(shape.edges.size()); ++e)
        for (int i = shape.edgeTriangles.start[e]; i < shape.edgeTriangles.start[e + 1]; ++i) {
            const int t = shape.edgeTriangles.items[i];
            for (int k = 0; k < 3; ++k) // the side that the opposite vertex is not on
                if (shape.triangles[t][(k + 2) % 3] == shape.edgeOpposites[i]) sides[t][k] = e;
        }
    return sides;
}

// [-] Sine of the angle between the triangles of an edge up to which it is flat. A board of 1 m that lies across such
// an edge is 0.05 mm deep in it.
constexpr double kFlatEdge = 1e-4;

/// Per edge whether its two triangles lie in one plane, at rest.
std::vector<char> flatEdgesOf(const CollisionShape& shape)
{
    std::vector<char> flat(shape.edges.size());
    for (int e = 0; e < static_cast<int>(shape.edges.size()); ++e) {
        const int start = shape.edgeTriangles.start[e];
        if (shape.edgeTriangles.start[e + 1] - start != 2) continue;
        const Vec3 a = shape.rest[shape.edges[e][0]], along = shape.rest[shape.edges[e][1]] - a;
        const Vec3 one = cross(along, shape.rest[shape.edgeOpposites[start]] - a);
        const Vec3 two = cross(shape.rest[shape.edgeOpposites[start + 1]] - a, along);
        const double sizes = length(one) * length(two);
        flat[e] = dot(one, two) > 0.0 && length(cross(one, two)) <= kFlatEdge * sizes;
    }
    return flat;
}

} // namespace

void connect(std::span<const EdgeUse> uses, CollisionShape& shape)
{
    shape.edges.clear();
    shape.edgeTriangles = {.start = {0}, .items = {}};
    shape.edgeOpposites.clear();
    shape.edges.reserve(uses.size() / 2 + 1);
    shape.edgeTriangles.start.reserve(uses.size() / 2 + 2);
    shape.edgeTriangles.items.reserve(uses.size());
    shape.edgeOpposites.reserve(uses.size());
    shape.closed = !shape.sheet && !shape.triangles.empty();
    for (std::size_t u = 0; u < uses.size();) {
        const auto [low, high] = shape.edges.emplace_back(uses[u].edge);
        int walked = 0;
        for (; u < uses.size() && uses[u].edge == shape.edges.back(); ++u) {
            if (uses[u].triangle < 0) continue;
            const auto [a, b, c] = shape.triangles[uses[u].triangle];
            shape.edgeTriangles.items.push_back(uses[u].triangle);
            shape.edgeOpposites.push_back(a + b + c - low - high);
            walked += (a == low && b == high) || (b == low && c == high) || (c == low && a == high) ? 1 : -1;
        }
        shape.edgeTriangles.start.push_back(static_cast<int>(shape.edgeTriangles.items.size()));
        shape.closed = shape.closed && walked == 0;
    }
    shape.vertexEdges = rowsOf(shape.rest.size(), [&](const auto& visit) {
        for (int e = 0; e < static_cast<int>(shape.edges.size()); ++e)
            for (const int vertex : shape.edges[e]) visit(vertex, e);
    });
    shape.vertexTriangles = rowsOf(shape.rest.size(), [&](const auto& visit) {
        for (int t = 0; t < static_cast<int>(shape.triangles.size()); ++t)
            for (const int vertex : shape.triangles[t]) visit(vertex, t);
    });
}

// As geometry::Bvh does it, but into full leaves, which needs fewer nodes.
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

Vec3 middleOf(const CollisionShape& shape, const CollisionShape::Element& element)
{
    geometry::Box box;
    for (const int v : element.vertices)
        if (v >= 0) box = merged(box, shape.rest[v]);
    return 0.5 * (box.low + box.high);
}

void plantTree(CollisionShape& shape)
{
    shape.elements.clear();
    shape.nodes.clear();
    shape.grafted = 0;
    collectElements(shape);
    if (shape.elements.empty()) return;
    std::vector<Vec3> middles;
    for (const CollisionShape::Element& element : shape.elements) middles.push_back(middleOf(shape, element));
    std::vector<int> order(shape.elements.size());
    std::iota(order.begin(), order.end(), 0);
    plant(middles, order, 0, shape.nodes);
    std::vector<CollisionShape::Element> inOrder;
    for (const int i : order) inOrder.push_back(shape.elements[i]);
    shape.elements = std::move(inOrder);
}

void shareOut(CollisionShape& shape)
{
    const std::vector<std::array<int, 3>> sides = sidesOf(shape);
    std::vector<char> vertexTaken(shape.rest.size()), edgeTaken(shape.edges.size());
    for (CollisionShape::Element& element : shape.elements) {
        element.ownVertices = element.ownEdges = {-1, -1, -1};
        for (int k = 0; k < 3; ++k) {
            const int a = element.vertices[k];
            if (a >= 0 && !vertexTaken[a]) vertexTaken[a] = 1, element.ownVertices[k] = a;
            if (element.triangle < 0) continue;
            const int edge = sides[element.triangle][k];
            if (!edgeTaken[edge]) edgeTaken[edge] = 1, element.ownEdges[k] = edge;
        }
        if (element.triangle >= 0 || element.vertices[1] < 0) continue; // a line owns its edge
        const auto line = std::array{element.vertices[0], element.vertices[1]};
        element.ownEdges[0] = static_cast<int>(std::ranges::lower_bound(shape.edges, line) - shape.edges.begin());
    }
}

CollisionShape makeCollisionShape(const geometry::TriangleMesh& mesh, const CollisionOptions& options)
{
    FILASOFIA_ASSERT(options.proximity >= 0.0 && options.depth >= 0.0);
    CollisionShape shape;
    shape.rest = mesh.vertices;
    shape.triangles = mesh.triangles;
    shape.points = options.points;
    shape.lines = options.lines;
    shape.triangleFaces = options.triangleFaces && !mesh.triangles.empty();
    shape.proximity = shape.ownProximity = options.proximity;
    shape.depth = std::max(options.depth, options.proximity);
    shape.partners = options.partners;
    shape.sheet = options.sheet;
    shape.group = options.group;
    shape.self = options.self;
    shape.cutting = options.cutting;
    shape.lone = options.lone;
    connect(edgeUses(shape, options.segments), shape);
    plantTree(shape);
    shareOut(shape);
    shape.lines = shape.lines && !shape.edges.empty();
    if (options.rigid) shape.flatEdges = flatEdgesOf(shape);
    return shape;
}

geometry::Box boxOf(const CollisionShape& shape, int triangle)
{
    geometry::Box box;
    for (const int vertex : shape.triangles[static_cast<std::size_t>(triangle)]) box = merged(box, shape.rest[vertex]);
    return box;
}

} // namespace filasofia::engine
