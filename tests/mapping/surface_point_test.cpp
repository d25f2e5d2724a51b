#include "filasofia/geometry/shapes.h"
#include "filasofia/mapping/surface_point.h"

namespace surface_point_test {

using namespace filasofia;
using namespace filasofia::mapping;

namespace {

constexpr double kPi = 3.14159265358979323846;

const geometry::TetMesh& block()
{
    static const auto mesh = geometry::shapes::block({0.02, 0.03, 0.04}, {2, 2, 2});
    return *mesh;
}

frame::SoftBodyFrame moved(const geometry::TetMesh& mesh, const auto& where)
{
    frame::SoftBodyFrame body;
    for (const Vec3& node : mesh.nodes) body.positions.push_back(where(node));
    return body;
}

frame::SoftBodyFrame atRest()
{
    return moved(block(), [](Vec3 p) { return p; });
}

/// A skin that is not part of the mesh: it is embedded in its tetrahedra.
MappedSurface skin() { return mapSurface(block(), *geometry::shapes::sphere(0.012, 6)); }

double angleBetween(Quat a, Quat b) { return length(rotationVector(conjugate(a) * b)); }

Vec3 axis(const Pose& pose, int k) { return toMat3(pose.orientation).column(k); }

} // namespace

TEST_CASE("a point on a surface at rest lies there, its frame looks outwards and stands upright")
{
    const SurfacePoint point = nearestPoint(mapBoundary(block()), {0.1, 0.004, 0.003}, "lamp");
    const Pose pose = apply(point, atRest(), point.rest.orientation);
    CHECK(distance(pose.position, {0.01, 0.004, 0.003}) < 1e-15);
    CHECK(distance(axis(pose, 2), {1, 0, 0}) < 1e-12);
    CHECK(distance(axis(pose, 1), {0, 1, 0}) < 1e-12);
}

TEST_CASE("there is a frame on a floor or a ceiling too, where no direction of the surface is upwards")
{
    for (const double side : {1.0, -1.0}) {
        const SurfacePoint point = nearestPoint(mapBoundary(block()), {0.001, side, 0.002}, "lamp");
        CHECK(distance(axis(point.rest, 2), {0, side, 0}) < 1e-12);
        CHECK(determinant(toMat3(point.rest.orientation)) == Approx(1.0));
    }
}

TEST_CASE("a rigid motion of the body moves the frame exactly, on its boundary and on a skin beside it")
{
    const Pose motion{{0.3, -0.2, 0.5}, axisAngle({1, -2, 0.5}, 2.5)};
    const frame::SoftBodyFrame body = moved(block(), [&](Vec3 p) { return transform(motion, p); });
    for (const MappedSurface& surface : {mapBoundary(block()), skin()})
        for (const Vec3 place : {Vec3{0.1, 0, 0}, {0, 0.1, 0}, {-0.1, 0.02, 0.3}, {0.004, -0.1, 0.001}}) {
            const SurfacePoint point = nearestPoint(surface, place, "lamp");
            const Pose now = apply(point, body, point.rest.orientation), expected = motion * point.rest;
            CHECK(distance(now.position, expected.position) < 1e-13);
            CHECK(angleBetween(now.orientation, expected.orientation) <
                  1e-7); // the angle is the square root of a rounding error
            for (int k = 0; k < 3; ++k) CHECK(distance(axis(now, k), axis(expected, k)) < 1e-11);
        }
}

TEST_CASE("stretching a body along its axes turns no frame, and shearing turns it half as far")
{
    const SurfacePoint point = nearestPoint(mapBoundary(block()), {0.002, 0.003, 1.0}, "lamp");
    const auto stretched = moved(block(), [](Vec3 p) { return Vec3{3.0 * p.x, 0.5 * p.y, 2.0 * p.z}; });
    CHECK(angleBetween(apply(point, stretched, point.rest.orientation).orientation, point.rest.orientation) < 1e-7);
    // Simple shear by s in the plane of the surface: its nearest rotation is by atan(s/2), clockwise.
    const double s = 0.4;
    const auto sheared = moved(block(), [&](Vec3 p) { return Vec3{p.x + s * p.y, p.y, p.z}; });
    const Quat turned = axisAngle({0, 0, 1}, -std::atan(s / 2)) * point.rest.orientation;
    CHECK(angleBetween(apply(point, sheared, point.rest.orientation).orientation, turned) < 1e-7);
}

TEST_CASE("the frame goes round continuously with a body that turns twice, and stays upright on the surface")
{
    const SurfacePoint point = nearestPoint(skin(), {0.01, 0.02, 0.005}, "lamp");
    Quat last = point.rest.orientation;
    const int steps = 400;
    double most = 0.0;
    for (int i = 1; i <= steps; ++i) {
        const double angle = 4.0 * kPi * i / steps;
        const Quat turn = axisAngle({0.2, 1, 0.3}, angle);
        const auto body = moved(block(), [&](Vec3 p) {
            const Vec3 bent{p.x + 5.0 * p.z * p.z * std::sin(angle), p.y, p.z + 3.0 * p.x * p.y};
            return rotate(turn, bent);
        });
        const Quat now = apply(point, body, last).orientation;
        most = std::max(most, angleBetween(last, now));
        last = now;
    }
    CHECK(most < 3.0 * 4.0 * kPi / steps);
}

TEST_CASE("if the triangle has collapsed or is not finite, the position follows and the orientation stays")
{
    const SurfacePoint point = nearestPoint(mapBoundary(block()), {0.1, 0.004, 0.003}, "lamp");
    const Quat last = axisAngle({1, 2, 3}, 0.7);
    const auto flat = moved(block(), [](Vec3 p) { return Vec3{p.x, 0.0, 0.0}; });
    CHECK(apply(point, flat, last).orientation == last);
    CHECK(apply(point, flat, last).position.x == Approx(0.01));
    const auto wrong = moved(block(), [](Vec3) { return Vec3{NAN, 0.0, 0.0}; });
    CHECK(apply(point, wrong, last).orientation == last);
}

TEST_CASE("a triangle and its weights give the point that they define")
{
    const MappedSurface boundary = mapBoundary(block());
    const auto& [a, b, c] = boundary.surface.triangles[7];
    const std::vector<Vec3>& at = boundary.surface.vertices;
    const SurfacePoint point = pointOnTriangle(boundary, 7, {0.2, 0.3, 0.5}, "lamp");
    CHECK(distance(point.rest.position, 0.2 * at[a] + 0.3 * at[b] + 0.5 * at[c]) < 1e-15);
}

TEST_CASE("a triangle that does not exist, one without area and wrong weights are Errors")
{
    MappedSurface boundary = mapBoundary(block());
    const int count = static_cast<int>(boundary.surface.triangles.size());
    CHECK_THROWS_WITH(pointOnTriangle(boundary, -1, {1, 0, 0}, "follow"),
                      Catch::Contains("follow: triangle must be in [0, ") && Catch::Contains("got -1"));
    CHECK_THROWS_WITH(pointOnTriangle(boundary, count, {1, 0, 0}, "follow"), Catch::Contains("triangle must be in"));
    CHECK_THROWS_WITH(pointOnTriangle(boundary, 0, {1.5, -0.5, 0}, "follow"),
                      "follow: each weight must be in [0, 1], got 1.5");
    CHECK_THROWS_WITH(pointOnTriangle(boundary, 0, {NAN, 0.5, 0.5}, "follow"), Catch::Contains("each weight must be"));
    CHECK_THROWS_WITH(pointOnTriangle(boundary, 0, {0.5, 0.2, 0.2}, "follow"),
                      Catch::Contains("sum of the weights must be 1"));
    boundary.surface.vertices[boundary.surface.triangles[0][1]] =
        boundary.surface.vertices[boundary.surface.triangles[0][0]];
    CHECK_THROWS_WITH(pointOnTriangle(boundary, 0, {1, 0, 0}, "follow"),
                      "follow: triangle 0 must have an area, got none");
    for (Vec3& vertex : boundary.surface.vertices) vertex = {};
    CHECK_THROWS_WITH(nearestPoint(boundary, {}, "follow"),
                      "follow: the surface must have a triangle with an area, got none");
}

} // namespace surface_point_test
