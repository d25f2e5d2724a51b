#include "filasofia/geometry/distance.h"
#include "filasofia/geometry/tet_mesh.h"
#include "geometry/sample_meshes.h"

namespace distance_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

template <std::size_t n> void checkConsistent(const Nearest<int(n)>& found, Vec3 p, const std::array<Vec3, n>& corners)
{
    Vec3 sum;
    double weights = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        CHECK(found.weights[i] >= 0.0);
        sum += found.weights[i] * corners[i];
        weights += found.weights[i];
    }
    CHECK(weights == Approx(1.0).epsilon(1e-14));
    CHECK(distance(sum, found.point) < 1e-13);
    CHECK(found.squaredDistance == Approx(lengthSquared(p - found.point)).margin(1e-28));
}

// A point of the simplex is nearest to p exactly if the vector to p makes no acute angle with the direction to any
// corner, because a simplex is convex.
template <std::size_t n> double worstImprovement(Vec3 point, Vec3 p, const std::array<Vec3, n>& corners)
{
    double worst = 0.0;
    for (Vec3 corner : corners) worst = std::max(worst, dot(p - point, corner - point));
    return worst;
}

} // namespace

TEST_CASE("the nearest point on segment, triangle and tetrahedron is where nothing nearer can be reached")
{
    std::mt19937 random(1);
    for (int i = 0; i < 5000; ++i) {
        const std::array<Vec3, 4> c{randomPoint(random, -1, 1), randomPoint(random, -1, 1), randomPoint(random, -1, 1),
                                    randomPoint(random, -1, 1)};
        const Vec3 p = randomPoint(random, -2, 2);
        const Nearest<2> onSegment = nearestOnSegment(p, c[0], c[1]);
        checkConsistent<2>(onSegment, p, {c[0], c[1]});
        CHECK(worstImprovement<2>(onSegment.point, p, {c[0], c[1]}) < 1e-13);
        const Nearest<3> onTriangle = nearestOnTriangle(p, c[0], c[1], c[2]);
        checkConsistent<3>(onTriangle, p, {c[0], c[1], c[2]});
        CHECK(worstImprovement<3>(onTriangle.point, p, {c[0], c[1], c[2]}) < 1e-12);
        const Nearest<4> inside = nearestInTetrahedron(p, c[0], c[1], c[2], c[3]);
        checkConsistent<4>(inside, p, c);
        CHECK(worstImprovement<4>(inside.point, p, c) < 1e-12);
    }
}

TEST_CASE("a point in a tetrahedron is nearest to itself, whichever way round the corners are")
{
    std::mt19937 random(2);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 a = randomPoint(random, -1, 1), b = randomPoint(random, -1, 1), c = randomPoint(random, -1, 1),
                   d = randomPoint(random, -1, 1);
        const Vec3 p = 0.1 * a + 0.2 * b + 0.3 * c + 0.4 * d;
        CHECK(nearestInTetrahedron(p, a, b, c, d).squaredDistance == 0.0);
        CHECK(nearestInTetrahedron(p, b, a, c, d).point == p);
    }
}

TEST_CASE("corners of segment, triangle and tetrahedron are their own nearest points")
{
    const std::array<Vec3, 4> c{Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 4; ++i) CHECK(nearestInTetrahedron(c[i], c[0], c[1], c[2], c[3]).weights[i] == 1.0);
    for (int i = 0; i < 3; ++i) CHECK(nearestOnTriangle(c[i], c[0], c[1], c[2]).weights[i] == 1.0);
    for (int i = 0; i < 2; ++i) CHECK(nearestOnSegment(c[i], c[0], c[1]).weights[i] == 1.0);
    CHECK(nearestInTetrahedron({-1, -1, -1}, c[0], c[1], c[2], c[3]).point == Vec3{});
    CHECK(nearestInTetrahedron({1, 1, 1}, c[0], c[1], c[2], c[3]).squaredDistance == Approx(4.0 / 3.0));
}

TEST_CASE("degenerate simplices answer for what is left of them, never with a NaN")
{
    const Vec3 a{1, 2, 3}, b{2, 4, 6}, c{4, 8, 12}, p{1, 0, 0};
    CHECK(nearestOnSegment(p, a, a).squaredDistance == Approx(13.0));
    CHECK(nearestOnTriangle(p, a, a, a).point == a);
    CHECK(nearestInTetrahedron(p, a, a, a, a).point == a);
    CHECK(nearestOnTriangle(p, a, b, c).squaredDistance == Approx(nearestOnSegment(p, a, c).squaredDistance));
    CHECK(nearestInTetrahedron(p, a, b, c, a).squaredDistance == Approx(nearestOnSegment(p, a, c).squaredDistance));
    const Vec3 q{0.2, 0.3, 5}, x{1, 0, 0}, y{0, 1, 0}, xy{1, 1, 0};
    CHECK(nearestInTetrahedron(q, {}, x, y, xy).squaredDistance == Approx(25.0));
}

TEST_CASE("barycentric weights give the point back, inside, outside and far from the origin")
{
    std::mt19937 random(3);
    const TetMesh mesh = cubeMesh(2, 1);
    for (Vec3 far : {Vec3{}, Vec3{1000, -1000, 500}})
        for (auto [a, b, c, d] : mesh.tetrahedra) {
            const Vec3 p = randomPoint(random, -1, 2) + far;
            const std::array<Vec3, 4> x{mesh.nodes[a] + far, mesh.nodes[b] + far, mesh.nodes[c] + far,
                                        mesh.nodes[d] + far};
            const auto w = barycentric(p, x[0], x[1], x[2], x[3]);
            CHECK(w[0] + w[1] + w[2] + w[3] == Approx(1.0).epsilon(1e-13));
            CHECK(distance(w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + w[3] * x[3], p) < 1e-13 * (1 + 30 * length(far)));
        }
}

TEST_CASE("a ray hits a triangle where a walk along it arrives, and misses beside, behind and along it")
{
    std::mt19937 random(4);
    std::uniform_real_distribution<double> number(0.1, 3.0);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 a = randomPoint(random, -1, 1), b = randomPoint(random, -1, 1), c = randomPoint(random, -1, 1);
        const Vec3 target = 0.2 * a + 0.3 * b + 0.5 * c, direction = randomPoint(random, -1, 1);
        const double along = number(random);
        const Vec3 origin = target - along * direction;
        CHECK(rayTriangle(origin, direction, a, b, c) == Approx(along).epsilon(1e-9));
        CHECK(rayTriangle(origin, direction, a, c, b) == Approx(along).epsilon(1e-9));
        CHECK(std::isinf(rayTriangle(origin, -direction, a, b, c)));
        CHECK(std::isinf(rayTriangle(origin + 3.0 * (b - a), direction, a, b, c)));
    }
    CHECK(std::isinf(rayTriangle({-1, 0.2, 0}, {1, 0, 0}, {}, {1, 0, 0}, {0, 1, 0})));
}

} // namespace distance_test
