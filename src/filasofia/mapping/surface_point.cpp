#include "filasofia/mapping/surface_point.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/error.h"
#include "filasofia/geometry/distance.h"
#include "filasofia/mapping/outside.h"
#include "filasofia/math/polar.h"

#include <algorithm>

namespace filasofia::mapping {
namespace {

using Corners = std::array<Vec3, 3>;

constexpr double kFlat =
    1e-12; ///< [-] an area smaller than this fraction of the square of the triangle's longest edge counts as none

Corners cornersOf(const MappedSurface& mapped, int triangle)
{
    const auto& [a, b, c] = mapped.surface.triangles[static_cast<std::size_t>(triangle)];
    const std::vector<Vec3>& vertices = mapped.surface.vertices;
    return {vertices[a], vertices[b], vertices[c]};
}

/// The normal with twice the area as its length; zero if the area is negligible.
Vec3 areaNormal(const Corners& corners)
{
    const Vec3 first = corners[1] - corners[0], second = corners[2] - corners[0];
    const Vec3 normal = cross(first, second);
    const double longest = std::max({lengthSquared(first), lengthSquared(second), lengthSquared(second - first)});
    return length(normal) > kFlat * longest ? normal : Vec3{}; // a comparison with NaN is false
}

/// Two edges and the normal, which determine the triangle's deformation. The normal's length is that of the triangle,
/// so that the matrix is well scaled at any size.
Mat3 edgesAndNormal(const Corners& corners, Vec3 normal, double scale)
{
    return Mat3::columns(corners[1] - corners[0], corners[2] - corners[0], scale * normalized(normal));
}

/// +Z along the normal, +Y as close as possible to the world's +Y.
Quat restOrientation(Vec3 normal)
{
    const Vec3 z = normalized(normal);
    const Vec3 right = cross({0, 1, 0}, z);
    const Vec3 x = normalized(length(right) > 1e-6 ? right : cross({0, 0, z.y > 0.0 ? -1.0 : 1.0}, z));
    return toQuat(Mat3::columns(x, cross(z, x), z));
}

geometry::Tetrahedron nodesOf(const IdentityMap& map, int vertex)
{
    const int node = map.nodes[static_cast<std::size_t>(vertex)];
    return {node, node, node, node};
}

geometry::Embedding onNodes(const SoftMap& map, const geometry::Triangle& triangle)
{
    geometry::Embedding corners;
    for (const int vertex : triangle) {
        if (const auto* identity = std::get_if<IdentityMap>(&map)) {
            corners.nodes.push_back(nodesOf(*identity, vertex));
            corners.weights.push_back({1.0, 0.0, 0.0, 0.0});
        } else {
            const geometry::Embedding& all = std::get<BarycentricMap>(map).embedding;
            corners.nodes.push_back(all.nodes[static_cast<std::size_t>(vertex)]);
            corners.weights.push_back(all.weights[static_cast<std::size_t>(vertex)]);
        }
    }
    return corners;
}

SurfacePoint make(const MappedSurface& mapped, int triangle, const std::array<double, 3>& weights)
{
    const Corners corners = cornersOf(mapped, triangle);
    const Vec3 normal = areaNormal(corners);
    SurfacePoint point;
    point.corners = onNodes(mapped.map, mapped.surface.triangles[static_cast<std::size_t>(triangle)]);
    point.weights = weights;
    point.rest = {mean(corners, weights), restOrientation(normal)};
    point.scale = std::sqrt(length(normal));
    point.restInverse = inverse(edgesAndNormal(corners, normal, point.scale));
    return point;
}

} // namespace

SurfacePoint pointOnTriangle(const MappedSurface& mapped, int triangle, const std::array<double, 3>& weights,
                             const std::string& object)
{
    const int count = static_cast<int>(mapped.surface.triangles.size());
    if (triangle < 0 || triangle >= count) fail(object, ": triangle must be in [0, ", count, "), got ", triangle);
    for (const double weight : weights)
        if (!(weight >= 0.0 && weight <= 1.0)) fail(object, ": each weight must be in [0, 1], got ", weight);
    const double sum = weights[0] + weights[1] + weights[2];
    if (!(std::abs(sum - 1.0) < 1e-9)) fail(object, ": the sum of the weights must be 1, got ", sum);
    if (areaNormal(cornersOf(mapped, triangle)) == Vec3{})
        fail(object, ": triangle ", triangle, " must have an area, got none");
    return make(mapped, triangle, weights);
}

SurfacePoint nearestPoint(const MappedSurface& mapped, Vec3 place, const std::string& object)
{
    int best = -1;
    geometry::Nearest<3> nearest;
    for (int t = 0; t < static_cast<int>(mapped.surface.triangles.size()); ++t) {
        const Corners corners = cornersOf(mapped, t);
        if (areaNormal(corners) == Vec3{}) continue;
        const auto here = geometry::nearestOnTriangle(place, corners[0], corners[1], corners[2]);
        if (best >= 0 && here.squaredDistance >= nearest.squaredDistance) continue;
        best = t;
        nearest = here;
    }
    if (best < 0) fail(object, ": the surface must have a triangle with an area, got none");
    return make(mapped, best, nearest.weights);
}

Pose apply(const SurfacePoint& point, const frame::SoftBodyFrame& body, Quat last)
{
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 4; ++k) {
            const auto node = static_cast<std::size_t>(point.corners.nodes[i][k]);
            FILASOFIA_ASSERT(node < body.positions.size());
            corners[i] += point.corners.weights[i][k] * body.positions[node];
        }
    const Vec3 normal = areaNormal(corners);
    const Vec3 place = mean(corners, point.weights);
    if (normal == Vec3{} || !isFinite(normal)) return {place, last};
    // The triangle's deformation maps edges to edges and the unit normal to the unit normal. So does the rotation
    // nearest to it, which is the body's own rotation if the body moves rigidly.
    const Mat3 deformation = edgesAndNormal(corners, normal, point.scale) * point.restInverse;
    const Quat guess = last * conjugate(point.rest.orientation);
    return {place, normalized(polarRotation(deformation, guess) * point.rest.orientation)};
}

} // namespace filasofia::mapping
