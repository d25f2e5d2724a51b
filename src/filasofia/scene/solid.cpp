#include "filasofia/scene/solid.h"

#include "filasofia/geometry/mass_properties.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/math/svd.h"
#include "filasofia/math/world_inertia.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace filasofia::scene {
namespace {

using geometry::TriangleMesh;
using Kind = Solid::Kind;

/// Turns what lies along y to lie along z.
Quat yToZ() { return axisAngle({1, 0, 0}, std::numbers::pi / 2); }

TriangleMesh mapped(TriangleMesh mesh, const Pose& pose)
{
    for (Vec3& each : mesh.vertices) each = transform(pose, each);
    mesh.uv.clear();
    return mesh;
}

/// In its own coordinates.
TriangleMesh surfaceOf(const Solid& solid)
{
    const Vec3 h = solid.half;
    switch (solid.kind) {
    case Kind::Box:
        return *geometry::shapes::box(2.0 * h);
    case Kind::Sphere:
        return *geometry::shapes::sphere(h.x);
    case Kind::Capsule:
        return mapped(*geometry::shapes::capsule(h.x, 2.0 * h.z), {{}, yToZ()});
    case Kind::Cylinder:
        return mapped(*geometry::shapes::cylinder(h.x, 2.0 * h.z), {{}, yToZ()});
    case Kind::Ellipsoid:
        return *geometry::shapes::ellipsoid(h);
    case Kind::Mesh:
        break;
    }
    return *solid.mesh;
}

/// The principal moments of a shape of mass 1 whose axes are its own.
Vec3 unitMoments(const Solid& solid)
{
    const Vec3 h = solid.half, s{h.x * h.x, h.y * h.y, h.z * h.z};
    const auto about = [](Vec3 second) { return Vec3{second.y + second.z, second.x + second.z, second.x + second.y}; };
    switch (solid.kind) {
    case Kind::Box:
        return about(s / 3.0);
    case Kind::Cylinder:
        return about({s.x / 4.0, s.x / 4.0, s.z / 3.0});
    case Kind::Capsule: { // a cylinder and two half balls, each with the second moments of its mass
        const double r = h.x, cylinder = 2.0 * h.z, balls = 4.0 / 3.0 * r, all = cylinder + balls;
        const double across = (cylinder * s.x / 4.0 + balls * s.x / 5.0) / all;
        const double along = (cylinder * s.z / 3.0 + balls * (s.x / 5.0 + s.z + 0.75 * r * h.z)) / all;
        return about({across, across, along});
    }
    default:
        return about(s / 5.0);
    }
}

double linear(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }

} // namespace

std::shared_ptr<const TriangleMesh> surfaceOf(const Solid& solid, const Pose& pose)
{
    if (solid.kind == Kind::Mesh && pose == Pose{}) return solid.mesh;
    return std::make_shared<const TriangleMesh>(mapped(surfaceOf(solid), pose));
}

std::shared_ptr<const TriangleMesh> scaled(const TriangleMesh& mesh, Vec3 scale)
{
    TriangleMesh out = mesh;
    for (Vec3& each : out.vertices) each = {scale.x * each.x, scale.y * each.y, scale.z * each.z};
    if (scale.x * scale.y * scale.z < 0.0)
        for (geometry::Triangle& each : out.triangles) std::swap(each[1], each[2]);
    return std::make_shared<const TriangleMesh>(std::move(out));
}

double volumeOf(const Solid& solid, std::string_view name)
{
    constexpr double pi = std::numbers::pi;
    const Vec3 h = solid.half;
    switch (solid.kind) {
    case Kind::Box:
        return 8.0 * h.x * h.y * h.z;
    case Kind::Cylinder:
        return 2.0 * pi * h.x * h.x * h.z;
    case Kind::Capsule:
        return pi * h.x * h.x * (2.0 * h.z + 4.0 / 3.0 * h.x);
    case Kind::Mesh:
        return geometry::massProperties(*solid.mesh, name).volume;
    default:
        return 4.0 / 3.0 * pi * h.x * h.y * h.z;
    }
}

physics::RigidInertia inertiaOf(const Solid& solid, double mass, std::string_view name)
{
    if (solid.kind != Kind::Mesh) return {mass, {}, Mat3::diagonal(mass * unitMoments(solid))};
    const geometry::MassProperties all = geometry::massProperties(*solid.mesh, name);
    return {mass, all.centre, (mass / all.volume) * all.inertia};
}

physics::RigidInertia moved(const Pose& pose, const physics::RigidInertia& inertia)
{
    if (pose.orientation == Quat{}) return {inertia.mass, transform(pose, inertia.centre), inertia.inertia};
    return {inertia.mass, transform(pose, inertia.centre), worldInertia(inertia.inertia, pose.orientation)};
}

physics::RigidInertia sumOf(const physics::RigidInertia& a, const physics::RigidInertia& b)
{
    if (!(a.mass > 0.0)) return b;
    if (!(b.mass > 0.0)) return a;
    physics::RigidInertia sum{a.mass + b.mass, {}, a.inertia + b.inertia};
    sum.centre = (a.mass * a.centre + b.mass * b.centre) / sum.mass;
    for (const physics::RigidInertia* each : {&a, &b}) { // Huygens and Steiner
        const Vec3 r = each->centre - sum.centre;
        sum.inertia += each->mass * (dot(r, r) * Mat3::identity() - outer(r, r));
    }
    return sum;
}

std::optional<physics::GivenInertia> principal(const physics::RigidInertia& inertia)
{
    const Mat3& m = inertia.inertia;
    physics::GivenInertia given{.mass = inertia.mass, .centre = inertia.centre};
    if (m[0].y == 0.0 && m[0].z == 0.0 && m[1].z == 0.0) {
        given.moments = {m[0].x, m[1].y, m[2].z};
    } else {
        Mat3 axes = svd(m).u; // the matrix is symmetric: these are its eigenvectors
        if (determinant(axes) < 0.0) axes = -1.0 * axes;
        const auto moment = [&](int k) { return dot(axes.column(k), m * axes.column(k)); };
        given.moments = {moment(0), moment(1), moment(2)};
        given.axes = normalized(toQuat(axes));
    }
    const Vec3 s = given.moments;
    const double largest = std::max({s.x, s.y, s.z});
    const bool possible = std::min({s.x, s.y, s.z}) > 0.0 && largest <= (1.0 + 5e-10) * (s.x + s.y + s.z - largest);
    if (!possible || !isFinite(s) || !isFinite(given.centre) || !(given.mass > 0.0)) return {};
    return given;
}

visual::Material plainMaterial(Vec3 rgb)
{
    return visual::plainMaterial({linear(rgb.x), linear(rgb.y), linear(rgb.z)});
}

} // namespace filasofia::scene
