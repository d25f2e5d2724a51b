#include "filasofia/engine/collision/edit_shape.h"

#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/distance.h"
#include "filasofia/math/mat3.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace filasofia::engine {
namespace {

constexpr double kMaxOfThickness = 0.25; // a quarter from each side
constexpr double kMaxOfEdge = 0.25;
constexpr double kMaxWay = 2.0;    // in depths, if triangles meet in a sharp point
constexpr double kTouching = 1e-3; // relative to the depth
constexpr double kRidge = 1e-3;    // regularisation: how different two normals must be to count as distinct

Vec3 normalOf(const geometry::Triangle& triangle, std::span<const Vec3> x)
{
    const auto [a, b, c] = triangle;
    const Vec3 ab = x[b] - x[a], ac = x[c] - x[a], normal = cross(ab, ac);
    const double longest = std::max(lengthSquared(ab), lengthSquared(ac));
    return lengthSquared(normal) > kSliver * longest * longest ? normalized(normal) : Vec3{};
}

/// Computes coefficients c with (sum of c_f n_f) . n_g = 1 for every triangle g around a vertex, by least
/// squares with the smallest c: (N N^T + e) c = 1, with the normals as the rows of N. With w = (N^T N + e)^-1 N^T 1,
/// this is c = (1 - N w) / e and N^T c = w. Returns the direction w.
Vec3 normalCoefficients(std::span<const Vec3> normals, std::span<double> shares)
{
    Mat3 products = kRidge * Mat3::identity();
    Vec3 sum;
    for (const Vec3 n : normals) {
        products += outer(n, n);
        sum += n;
    }
    const Vec3 way = inverse(products) * sum;
    const double size = length(way), scale = size > kMaxWay ? kMaxWay / size : 1.0;
    for (std::size_t f = 0; f < normals.size(); ++f)
        shares[f] = normals[f] == Vec3{} ? 0.0 : scale * (1.0 - dot(normals[f], way)) / kRidge; // zero area
    return scale * way;
}

/// A ray inwards from a vertex.
struct Probe {
    const CollisionShape& shape;
    int vertex;
    Vec3 from, inwards;
    double nearest; ///< [m] hits nearer than this are not the thickness but the other wall of a cut

    /// [m] distance to a triangle that does not have the vertex; infinite if the ray misses it.
    [[nodiscard]] double hit(int triangle) const
    {
        constexpr double none = std::numeric_limits<double>::infinity();
        const auto [a, b, c] = shape.triangles[static_cast<std::size_t>(triangle)];
        if (a == vertex || b == vertex || c == vertex) return none;
        const double way = geometry::rayTriangle(from, inwards, shape.rest[a], shape.rest[b], shape.rest[c]);
        return way > nearest ? way : none;
    }
};

/// [m] distance from which on another wall does not reduce the inset.
double reachOf(double depth) { return depth / kMaxOfThickness; }

/// Computes one vertex's inset. thickness(probe) returns the distance [m] to the first hit within reachOf(depth), or
/// more.
template <class Thickness> void insetVertex(const CollisionShape& shape, int vertex, double depth,
                                            const Thickness& thickness, std::vector<Vec3>& normals, Inset& inset)
{
    const std::span<const int> around = shape.vertexTriangles[vertex];
    inset.depth[vertex] = 0.0;
    if (around.empty()) return;
    normals.clear();
    for (const int t : around) normals.push_back(normalOf(shape.triangles[static_cast<std::size_t>(t)], shape.rest));
    const Vec3 way = normalCoefficients(
        normals,
        std::span(inset.share).subspan(static_cast<std::size_t>(shape.vertexTriangles.start[vertex]), around.size()));
    double limit = kMaxOfThickness * thickness(Probe{shape, vertex, shape.rest[static_cast<std::size_t>(vertex)],
                                                     normalized(-way), kTouching * depth});
    for (int edge : shape.vertexEdges[vertex]) {
        const auto [a, b] = shape.edges[edge];
        limit = std::min(limit, kMaxOfEdge * distance(shape.rest[a], shape.rest[b]));
    }
    inset.depth[vertex] = std::min(depth, limit);
}

Inset noInset(const CollisionShape& shape)
{
    return {.depth = std::vector<double>(shape.rest.size()),
            .share = std::vector<double>(shape.vertexTriangles.items.size())};
}

bool hasInset(const CollisionShape& shape, double depth) { return shape.closed && shape.triangleFaces && depth > 0.0; }

/// The vertices whose inset may differ after an edit: those of the changed triangles, and those that the change is in
/// reach of.
std::vector<int> affectedVertices(const CollisionShape& now, const ShapeChange& change, double depth)
{
    std::vector<int> affected;
    const geometry::Box box = grown(change.box, reachOf(depth));
    auto touched = change.touched.begin();
    for (int vertex = 0; vertex < static_cast<int>(now.rest.size()); ++vertex) {
        const bool is = touched != change.touched.end() && *touched == vertex;
        if (is) ++touched;
        if (is || squaredDistance(box, now.rest[vertex]) == 0.0) affected.push_back(vertex);
    }
    return affected;
}

/// The triangles that a ray from any of the vertices may hit, with their boxes.
std::vector<std::pair<int, geometry::Box>> trianglesNear(const CollisionShape& shape, std::span<const int> vertices,
                                                         double reach)
{
    geometry::Box region;
    for (const int vertex : vertices) region = merged(region, shape.rest[vertex]);
    region = grown(region, reach);
    std::vector<std::pair<int, geometry::Box>> near;
    for (int t = 0; t < static_cast<int>(shape.triangles.size()); ++t)
        if (const geometry::Box box = boxOf(shape, t); overlap(box, region)) near.push_back({t, box});
    return near;
}

} // namespace

Inset makeInset(const CollisionShape& shape, double depth)
{
    Inset inset = noInset(shape);
    if (!hasInset(shape, depth)) return inset;
    std::vector<geometry::Box> boxes;
    for (int t = 0; t < static_cast<int>(shape.triangles.size()); ++t) boxes.push_back(boxOf(shape, t));
    const geometry::Bvh tree(boxes);
    const auto thickness = [&](const Probe& probe) {
        return tree
            .firstHit(
                probe.from, probe.inwards, [&](int t) { return probe.hit(t); }, reachOf(depth))
            .value;
    };
    std::vector<Vec3> normals;
    for (int vertex = 0; vertex < static_cast<int>(shape.rest.size()); ++vertex)
        insetVertex(shape, vertex, depth, thickness, normals, inset);
    return inset;
}

Inset roundInset(const CollisionShape& shape, double radius)
{
    return {.depth = std::vector<double>(shape.rest.size(), radius),
            .share = std::vector<double>(shape.vertexTriangles.items.size())};
}

Inset editInset(const Inset& inset, const CollisionShape& before, const CollisionShape& now, const ShapeChange& change,
                double depth)
{
    if (!hasInset(now, depth)) return noInset(now);
    if (!hasInset(before, depth)) return makeInset(now, depth);
    Inset out = noInset(now);
    const std::vector<int> affected = affectedVertices(now, change, depth);
    const auto near = trianglesNear(now, affected, reachOf(depth));
    const auto thickness = [&](const Probe& probe) {
        const geometry::Box way =
            merged(geometry::Box{probe.from, probe.from}, probe.from + 1.001 * reachOf(depth) * probe.inwards);
        double nearest = std::numeric_limits<double>::infinity();
        for (const auto& [t, box] : near)
            if (overlap(box, way)) nearest = std::min(nearest, probe.hit(t));
        return nearest;
    };
    std::vector<Vec3> normals;
    auto next = affected.begin();
    for (int vertex = 0; vertex < static_cast<int>(now.rest.size()); ++vertex) {
        if (next != affected.end() && *next == vertex) {
            ++next;
            insetVertex(now, vertex, depth, thickness, normals, out);
            continue;
        }
        out.depth[vertex] = inset.depth[vertex];
        const std::span<const int> old = before.vertexTriangles[vertex];
        std::copy_n(inset.share.begin() + before.vertexTriangles.start[vertex], old.size(),
                    out.share.begin() + now.vertexTriangles.start[vertex]);
    }
    return out;
}

void applyInset(const CollisionShape& shape, const Inset& inset, std::vector<Vec3>& normals, std::span<Vec3> x)
{
    normals.resize(shape.triangles.size());
    for (std::size_t t = 0; t < normals.size(); ++t) normals[t] = normalOf(shape.triangles[t], x);
    for (int vertex = 0; vertex < static_cast<int>(x.size()); ++vertex) {
        const double depth = inset.depth[vertex];
        if (depth == 0.0 || shape.vertexTriangles[vertex].empty()) continue;
        Vec3 way;
        double sum = 0.0;
        for (int i = shape.vertexTriangles.start[vertex]; i < shape.vertexTriangles.start[vertex + 1]; ++i) {
            way += inset.share[i] * normals[shape.vertexTriangles.items[i]];
            sum += inset.share[i];
        }
        // If the surface has deformed, the triangles still move by the depth on average, weighted by their
        // coefficients.
        const double size = length(way);
        if (size > 0.0 && sum > 0.0) way = std::min(sum / size, kMaxWay) / size * way;
        x[vertex] -= depth * way;
    }
}

} // namespace filasofia::engine
