#include "filasofia/engine/collision/inset.h"

#include "filasofia/geometry/bvh.h"
#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace filasofia::engine {
namespace {

constexpr double kMostOfThickness = 0.25; // a quarter from each side
constexpr double kMostOfEdge = 0.25;
constexpr double kLongestWay = 2.0; // in depths, where triangles meet in a point
constexpr double kSliver = 1e-18;   // [-] as in meet_point.cpp: has no face
constexpr double kRidge = 1e-3;     // how nearly alike two normals may be, to be told apart

void normalsOf(const CollisionShape& shape, std::span<const Vec3> x, std::vector<Vec3>& normals)
{
    normals.resize(shape.triangles.size());
    for (std::size_t t = 0; t < normals.size(); ++t) {
        const auto [a, b, c] = shape.triangles[t];
        const Vec3 ab = x[b] - x[a], ac = x[c] - x[a], normal = cross(ab, ac);
        const double longest = std::max(lengthSquared(ab), lengthSquared(ac));
        normals[t] = lengthSquared(normal) > kSliver * longest * longest ? normalized(normal) : Vec3{};
    }
}

/// Shares c with (sum of c_f n_f) . n_g = 1 for every triangle g around a vertex, as nearly as there are, the smallest:
/// (G + e) c = 1, G the normals' products, by Gauss-Seidel.
void shareOut(std::span<const int> around, const std::vector<Vec3>& normals, std::span<double> shares)
{
    std::fill(shares.begin(), shares.end(), 0.0);
    Vec3 way;
    for (int sweep = 0; sweep < 200; ++sweep)
        for (std::size_t f = 0; f < around.size(); ++f) {
            const Vec3 n = normals[static_cast<std::size_t>(around[f])];
            if (n == Vec3{}) continue; // without area, without a say
            const double change = (1.0 - dot(way, n) - kRidge * shares[f]) / (lengthSquared(n) + kRidge);
            shares[f] += change;
            way += change * n;
        }
    if (const double size = length(way); size > kLongestWay)
        for (double& share : shares) share *= kLongestWay / size;
}

/// [m] inwards from a vertex to the opposite wall; infinite where the ray slips through between two triangles.
double thicknessAt(const CollisionShape& shape, const geometry::Bvh& tree, int vertex, Vec3 inwards)
{
    const Vec3 from = shape.rest[static_cast<std::size_t>(vertex)];
    const auto hit = [&](int triangle) {
        const auto [a, b, c] = shape.triangles[static_cast<std::size_t>(triangle)];
        if (a == vertex || b == vertex || c == vertex) return std::numeric_limits<double>::infinity();
        return geometry::rayTriangle(from, inwards, shape.rest[a], shape.rest[b], shape.rest[c]);
    };
    return tree.firstHit(from, inwards, hit).value;
}

} // namespace

Inset makeInset(const CollisionShape& shape, double depth)
{
    Inset inset{.depth = std::vector<double>(shape.rest.size()),
                .share = std::vector<double>(shape.vertexTriangles.items.size())};
    if (!shape.closed || !shape.triangleFaces || depth == 0.0) return inset;
    std::vector<geometry::Box> boxes;
    for (const geometry::Triangle& t : shape.triangles) {
        geometry::Box box;
        for (int vertex : t) box = geometry::merged(box, shape.rest[vertex]);
        boxes.push_back(box);
    }
    const geometry::Bvh tree(boxes);
    std::vector<Vec3> normals;
    normalsOf(shape, shape.rest, normals);
    for (int vertex = 0; vertex < static_cast<int>(shape.rest.size()); ++vertex) {
        const std::span<const int> around = shape.vertexTriangles[vertex];
        if (around.empty()) continue;
        const std::span<double> shares =
            std::span(inset.share).subspan(shape.vertexTriangles.start[vertex], around.size());
        shareOut(around, normals, shares);
        Vec3 way;
        for (std::size_t f = 0; f < around.size(); ++f) way -= shares[f] * normals[around[f]];
        double most = kMostOfThickness * thicknessAt(shape, tree, vertex, normalized(way));
        for (int edge : shape.vertexEdges[vertex]) {
            const auto [a, b] = shape.edges[edge];
            most = std::min(most, kMostOfEdge * distance(shape.rest[a], shape.rest[b]));
        }
        inset.depth[vertex] = std::min(depth, most);
    }
    return inset;
}

void applyInset(const CollisionShape& shape, const Inset& inset, std::vector<Vec3>& normals, std::span<Vec3> x)
{
    normalsOf(shape, x, normals);
    for (int vertex = 0; vertex < static_cast<int>(x.size()); ++vertex) {
        const double depth = inset.depth[vertex];
        if (depth == 0.0) continue;
        Vec3 way;
        for (int i = shape.vertexTriangles.start[vertex]; i < shape.vertexTriangles.start[vertex + 1]; ++i)
            way += inset.share[i] * normals[shape.vertexTriangles.items[i]];
        x[vertex] -= depth * way;
    }
}

} // namespace filasofia::engine
