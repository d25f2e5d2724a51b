#include "filasofia/engine/collision/feature_normals.h"

#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace filasofia::engine {
namespace {

// [-] tolerance relative to the distance: two boards that lie across each other cross at the side of one.
constexpr double kGraze = 2e-3;

// The normal of the feature that the weights place the point on: face, edge or vertex.
Vec3 normalAt(const CollisionSurface& surface, int triangle, const std::array<double, 3>& weights)
{
    const geometry::Triangle& corners = surface.shape->triangles[triangle];
    if (weights[0] > 0.0 && weights[1] > 0.0 && weights[2] > 0.0) return faceNormal(surface, triangle);
    std::array<int, 3> feature{-1, -1, -1};
    for (int k = 0, count = 0; k < 3; ++k)
        if (weights[k] > 0.0) feature[count++] = corners[k];
    return featureNormal(surface, feature);
}

struct NearestPlace {
    double squaredDistance = std::numeric_limits<double>::infinity();
    int triangle = -1;
    geometry::Nearest<3> nearest;
};

Bounds boxAround(Vec3 point, double distance)
{
    // Slightly enlarged, so that rounding cannot lose the place that is known.
    const auto reach = static_cast<float>(distance * 1.000001 + 1e-9);
    const float x = static_cast<float>(point.x), y = static_cast<float>(point.y), z = static_cast<float>(point.z);
    const float r = reach + 1e-6f * (std::fabs(x) + std::fabs(y) + std::fabs(z));
    return {FourFloats{x - r, y - r, z - r, 0.0f}, FourFloats{-x - r, -y - r, -z - r, 0.0f}};
}

// The box shrinks to the distance found so far.
void search(const CollisionSurface& surface, Vec3 point, Bounds& box, int at, NearestPlace& best)
{
    if (!meet(surface.nodeBounds[at], box)) return;
    const CollisionShape& shape = *surface.shape;
    const CollisionShape::Node& node = shape.nodes[at];
    if (node.count == 0) {
        search(surface, point, box, at + 1, best);
        search(surface, point, box, node.first, best);
        return;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
        const int t = shape.elements[i].triangle;
        if (t < 0 || !meet(surface.elementBounds[i], box)) continue;
        const auto [a, b, c] = shape.triangles[t];
        const geometry::Nearest<3> here = geometry::nearestOnTriangle(point, surface.x[a], surface.x[b], surface.x[c]);
        if (!(here.squaredDistance < best.squaredDistance)) continue;
        best = {here.squaredDistance, t, here};
        box = boxAround(point, std::sqrt(here.squaredDistance));
    }
}

} // namespace

Vec3 faceNormal(const CollisionSurface& surface, int triangle)
{
    const auto [a, b, c] = surface.shape->triangles[triangle];
    return cross(surface.x[b] - surface.x[a], surface.x[c] - surface.x[a]);
}

Vec3 edgeNormal(const CollisionSurface& surface, int edge)
{
    Vec3 sum;
    for (const int t : surface.shape->edgeTriangles[edge]) sum += normalized(faceNormal(surface, t));
    return sum;
}

Vec3 vertexNormal(const CollisionSurface& surface, int vertex)
{
    Vec3 sum;
    for (const int t : surface.shape->vertexTriangles[vertex]) {
        const geometry::Triangle& corners = surface.shape->triangles[t];
        const int k = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
        const Vec3 to = surface.x[corners[(k + 1) % 3]] - surface.x[vertex];
        const Vec3 from = surface.x[corners[(k + 2) % 3]] - surface.x[vertex];
        const Vec3 normal = cross(to, from);
        sum += std::atan2(length(normal), dot(to, from)) * normalized(normal);
    }
    return sum;
}

Vec3 featureNormal(const CollisionSurface& surface, const std::array<int, 3>& vertices)
{
    const CollisionShape& shape = *surface.shape;
    const auto [a, b, c] = vertices;
    if (b < 0) return vertexNormal(surface, a);
    if (c < 0) {
        for (const int e : shape.vertexEdges[a])
            if (shape.edges[e][0] == b || shape.edges[e][1] == b) return edgeNormal(surface, e);
        return {};
    }
    for (const int t : shape.vertexTriangles[a]) {
        const geometry::Triangle& corners = shape.triangles[t];
        if (std::ranges::find(corners, b) != corners.end() && std::ranges::find(corners, c) != corners.end())
            return faceNormal(surface, t);
    }
    return {};
}

bool rimEdge(const CollisionShape& shape, int edge) { return shape.edgeTriangles[edge].size() == 1; }

bool rimVertex(const CollisionShape& shape, int vertex)
{
    return std::ranges::any_of(shape.vertexEdges[vertex], [&](int e) { return rimEdge(shape, e); });
}

NearestOnSurface nearestOn(const CollisionSurface& surface, Vec3 point, double distance)
{
    NearestPlace best;
    Bounds box = boxAround(point, distance);
    search(surface, point, box, 0, best);
    if (best.triangle < 0) return {};
    const std::array<double, 3>& weights = best.nearest.weights;
    return {best.triangle, weights, best.nearest.point, normalAt(surface, best.triangle, weights)};
}

bool inside(const CollisionSurface& surface, Vec3 point, double distance)
{
    const NearestOnSurface nearest = nearestOn(surface, point, distance);
    return nearest.triangle >= 0 &&
           dot(point - nearest.place, nearest.normal) <= kGraze * distance * length(nearest.normal);
}

double depthInside(const CollisionSurface& surface, Vec3 point)
{
    const NearestOnSurface nearest = nearestOn(surface, point, sizeOf(surface));
    const Vec3 out = nearest.place - point;
    return nearest.triangle >= 0 && dot(out, nearest.normal) > 0.0 ? length(out) : 0.0;
}

} // namespace filasofia::engine
