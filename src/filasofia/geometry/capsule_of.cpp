#include "filasofia/geometry/capsule_of.h"

#include "filasofia/geometry/distance.h"
#include "filasofia/geometry/mass_properties.h"
#include "filasofia/math/mat3.h"
#include "filasofia/math/svd.h"

#include <algorithm>
#include <cmath>

namespace filasofia::geometry {
namespace {

constexpr double kOn = 1e-4; // [-] relative to the radius: files hold floats
constexpr double kFaces =
    0.06; // [-] how deep a face may be inside, relative to the radius: with four edges per quarter, 0.052

bool isNear(const TriangleMesh& mesh, const Capsule& capsule)
{
    const auto away = [&](Vec3 p) {
        return std::sqrt(nearestOnSegment(p, capsule.ends[0], capsule.ends[1]).squaredDistance) / capsule.radius - 1.0;
    };
    return std::ranges::all_of(mesh.vertices, [&](Vec3 v) { return std::fabs(away(v)) < kOn; }) &&
           std::ranges::all_of(mesh.triangles, [&](const Triangle& t) {
               const Vec3 a = mesh.vertices[static_cast<std::size_t>(t[0])],
                          b = mesh.vertices[static_cast<std::size_t>(t[1])],
                          c = mesh.vertices[static_cast<std::size_t>(t[2])];
               return away((a + b + c) / 3.0) > -kFaces;
           });
}

/// The centre of the sphere, or of the circle around `axis` (0: sphere), that fits points around their mean best: the
/// least squares of |q|^2 - 2 c.q - mean |q|^2.
Vec3 centreOf(const std::vector<Vec3>& around, Vec3 axis)
{
    Mat3 products = outer(axis, axis);
    Vec3 sum;
    for (const Vec3 each : around) {
        const Vec3 q = each - dot(each, axis) * axis;
        products += outer(q, q);
        sum += lengthSquared(q) * q;
    }
    return 0.5 * (inverse(products) * sum);
}

} // namespace

std::optional<Capsule> capsuleOf(const TriangleMesh& mesh)
{
    if (mesh.vertices.size() < 8 || mesh.triangles.empty()) return {};
    Vec3 mean;
    for (const Vec3 v : mesh.vertices) mean += 1.0 / static_cast<double>(mesh.vertices.size()) * v;
    std::vector<Vec3> around;
    Mat3 products{};
    for (const Vec3 v : mesh.vertices) {
        around.push_back(v - mean);
        products += outer(v - mean, v - mean);
    }
    const Mat3 axes = svd(products).u;
    // The longest axis comes first, but the vertices of a short capsule may spread most across it.
    for (const Vec3 axis : {Vec3{}, axes.column(0), axes.column(1), axes.column(2)}) {
        const Vec3 centre = centreOf(around, axis);
        double radius = 0.0, low = 0.0, high = 0.0;
        for (const Vec3 q : around) {
            const double along = dot(q, axis);
            low = std::min(low, along), high = std::max(high, along);
            radius = std::max(radius, length(q - centre - along * axis));
        }
        const double half = 0.5 * (high - low) - radius;
        const Vec3 middle = mean + centre + 0.5 * (high + low) * axis, arm = axis == Vec3{} ? Vec3{} : half * axis;
        const Capsule fit{{middle - arm, middle + arm}, radius};
        if (radius > 0.0 && (axis == Vec3{} || half > 0.0) && isNear(mesh, fit) && enclosedVolume(mesh) > 0.0)
            return fit;
    }
    return {};
}

} // namespace filasofia::geometry
