#include "filasofia/geometry/capsule_of.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/math/pose.h"

#include <catch2/catch.hpp>

namespace capsule_of_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

TriangleMesh moved(TriangleMesh mesh, const Pose& pose, double scale = 1.0)
{
    for (Vec3& v : mesh.vertices) v = transform(pose, scale * v);
    return mesh;
}

const Pose kSomewhere{{0.3, -0.2, 1.5}, normalized(Quat{0.3, 0.5, -0.2, 0.7})};

} // namespace

TEST_CASE("a mesh on a sphere is that ball, wherever it is")
{
    for (const int quarter : {4, 8, 20}) {
        const auto ball = capsuleOf(moved(*shapes::sphere(0.01, quarter), kSomewhere, 2.0));
        REQUIRE(ball);
        CHECK(ball->radius == Approx(0.02));
        CHECK(ball->ends[0] == ball->ends[1]);
        CHECK(distance(ball->ends[0], kSomewhere.position) < 1e-12);
    }
}

TEST_CASE("a mesh on a capsule is that capsule, wherever it is")
{
    for (const double length : {1e-3, 0.03, 0.3}) {
        const auto capsule = capsuleOf(moved(*shapes::capsule(0.01, length), kSomewhere));
        REQUIRE(capsule);
        CHECK(capsule->radius == Approx(0.01));
        const Vec3 end = rotate(kSomewhere.orientation, {0, 0.5 * length, 0});
        std::array<Vec3, 2> ends = capsule->ends;
        if (dot(ends[0] - ends[1], end) < 0.0) std::swap(ends[0], ends[1]);
        CHECK(distance(ends[0], kSomewhere.position + end) < 1e-9);
        CHECK(distance(ends[1], kSomewhere.position - end) < 1e-9);
    }
}

TEST_CASE("what is coarse, flat, turned inside out or another shape is no ball and no capsule")
{
    TriangleMesh room = *shapes::sphere(0.01), half = room;
    for (Triangle& t : room.triangles) std::swap(t[1], t[2]);
    for (Vec3& v : half.vertices) v.y = std::max(v.y, 0.0);
    for (const TriangleMesh& mesh :
         {*shapes::sphere(0.01, 1), *shapes::sphere(0.01, 2), *shapes::box({0.02, 0.02, 0.02}),
          *shapes::box({0.02, 0.02, 0.02}, {8, 8, 8}), *shapes::cylinder(0.01, 0.03),
          *shapes::ellipsoid({0.01, 0.01, 0.0101}), *shapes::sheet(0.02, 0.02), room, half})
        CHECK(!capsuleOf(mesh));
}

} // namespace capsule_of_test
