#include "filasofia/geometry/shapes.h"

#include "filasofia/core/error.h"

#include <cmath>
#include <numbers>

namespace filasofia::geometry::shapes {
namespace {

void check(const std::vector<Vec3>& points, double radius, int sides)
{
    if (points.size() < 2) fail("tube: points must have at least 2 entries, got ", points.size());
    if (!(radius > 0.0 && std::isfinite(radius))) fail("tube: radius must be > 0 m, got ", radius);
    if (sides < 3 || sides > 500) fail("tube: sides must be in [3, 500], got ", sides);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!isFinite(points[i])) fail("tube: points[", i, "] must be finite");
        if (i > 0 && !(length(points[i] - points[i - 1]) > 0.0))
            fail("tube: points[", i - 1, "] and points[", i, "] must be apart, their distance is 0 m");
    }
}

Vec3 anyAcross(Vec3 direction)
{
    return normalized(cross(direction, std::abs(direction.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
}

} // namespace

std::shared_ptr<const TriangleMesh> tube(const std::vector<Vec3>& points, double radius, int sides, bool sharp)
{
    check(points, radius, sides);
    TriangleMesh mesh;
    const auto edge = [&](std::size_t i) { return normalized(points[i + 1] - points[i]); };
    const std::size_t count = points.size();
    Vec3 across = anyAcross(edge(0));
    for (std::size_t i = sharp ? 1 : 0; i < count; ++i) {
        const Vec3 before = edge(i > 0 ? i - 1 : 0), after = edge(i + 1 < count ? i : count - 2);
        const Vec3 sum = before + after;
        if (!(length(sum) > 0.1)) fail("tube: the line must turn by less than 174 degrees at points[", i, "]");
        const Vec3 along = normalized(sum);
        across = normalized(across - dot(across, along) * along); // turned as little as possible
        const Vec3 up = cross(along, across);
        for (int s = 0; s < sides; ++s) {
            const double angle = 2.0 * std::numbers::pi * s / sides;
            mesh.vertices.push_back(points[i] + radius * (std::cos(angle) * across + std::sin(angle) * up));
        }
    }
    const int rings = static_cast<int>(mesh.vertices.size()) / sides;
    const int front = static_cast<int>(mesh.vertices.size()), back = front + 1;
    mesh.vertices.push_back(points.front());
    mesh.vertices.push_back(points.back());
    for (int s = 0; s < sides; ++s) {
        const int t = (s + 1) % sides, last = (rings - 1) * sides;
        mesh.triangles.push_back({front, t, s});
        for (int r = 0; r + 1 < rings; ++r) {
            const int a = r * sides + s, b = r * sides + t;
            mesh.triangles.push_back({a, b, a + sides});
            mesh.triangles.push_back({b, b + sides, a + sides});
        }
        mesh.triangles.push_back({back, last + s, last + t});
    }
    return std::make_shared<const TriangleMesh>(std::move(mesh));
}

} // namespace filasofia::geometry::shapes
