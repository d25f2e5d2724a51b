#include "filasofia/geometry/mass_properties.h"

#include "filasofia/math/quat.h"

#include "geometry/sample_meshes.h"

#include <map>
#include <numbers>

namespace mass_properties_test {

using namespace filasofia;
using namespace filasofia::geometry;

namespace {

/// A box with its low corner at the origin.
TriangleMesh box(Vec3 size)
{
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) mesh.vertices.push_back({i & 4 ? size.x : 0, i & 2 ? size.y : 0, i & 1 ? size.z : 0});
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                      {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
    return mesh;
}

Mat3 boxInertia(Vec3 s)
{
    const double x = s.x * s.x, y = s.y * s.y, z = s.z * s.z;
    return s.x * s.y * s.z / 12.0 * Mat3::diagonal({y + z, z + x, x + y});
}

/// An octahedron whose triangles were divided in four and projected onto the sphere, this many times.
TriangleMesh sphere(double radius, int times)
{
    TriangleMesh mesh{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}},
                      {}};
    for (int i = 0; i < times; ++i) {
        TriangleMesh fine{mesh.vertices, {}, {}};
        std::map<std::array<int, 2>, int> middles;
        const auto middle = [&](int a, int b) {
            const auto [place, fresh] =
                middles.try_emplace({std::min(a, b), std::max(a, b)}, static_cast<int>(fine.vertices.size()));
            if (fresh) fine.vertices.push_back(normalized(mesh.vertices[a] + mesh.vertices[b]));
            return place->second;
        };
        for (const auto& [a, b, c] : mesh.triangles) {
            const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            for (const Triangle& t : {Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
                fine.triangles.push_back(t);
        }
        mesh = fine;
    }
    for (Vec3& v : mesh.vertices) v *= radius;
    return mesh;
}

TriangleMesh placed(TriangleMesh mesh, Quat rotation, Vec3 shift)
{
    for (Vec3& v : mesh.vertices) v = shift + rotate(rotation, v);
    return mesh;
}

/// Both bodies' surfaces in one mesh.
TriangleMesh together(TriangleMesh a, const TriangleMesh& b)
{
    const int n = static_cast<int>(a.vertices.size());
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + n, j + n, k + n});
    return a;
}

TriangleMesh insideOut(TriangleMesh mesh)
{
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

Mat3 rotated(const Mat3& inertia, Quat rotation)
{
    const Mat3 r = toMat3(rotation);
    return r * inertia * transpose(r);
}

void checkSame(const Mat3& a, const Mat3& b, double tolerance)
{
    CHECK(frobeniusNorm(a - b) <= tolerance * frobeniusNorm(b));
}

void checkRefused(const TriangleMesh& mesh, const std::vector<std::string>& parts)
{
    const std::string error = errorOf([&] { massProperties(mesh, "mesh 'm'"); });
    for (const std::string& part : parts) CHECK_THAT(error, Catch::Contains(part));
}

} // namespace

TEST_CASE("a box has the volume, the centre and the inertia of a box")
{
    const Vec3 size{0.3, 0.02, 0.1};
    const MassProperties body = massProperties(box(size), "box");
    CHECK(body.volume == Approx(6e-4).epsilon(1e-13));
    CHECK(distance(body.centre, 0.5 * size) < 1e-15);
    checkSame(body.inertia, boxInertia(size), 1e-13);
}

// Second moments of the corner tetrahedron 0 <= x + y + z <= 1 about its corner: 1/60 on the diagonal, 1/120 beside it.
TEST_CASE("a tetrahedron has the inertia of a tetrahedron")
{
    const MassProperties body = massProperties(extractSurface(unitTetrahedron()).mesh, "tetrahedron");
    CHECK(body.volume == Approx(1.0 / 6.0).epsilon(1e-14));
    CHECK(distance(body.centre, {0.25, 0.25, 0.25}) < 1e-15);
    const double diagonal = 2.0 * (1.0 / 60.0 - 1.0 / 96.0), beside = -(1.0 / 120.0 - 1.0 / 96.0);
    const Mat3 expected{{{diagonal, beside, beside}, {beside, diagonal, beside}, {beside, beside, diagonal}}};
    checkSame(body.inertia, expected, 1e-13);
}

TEST_CASE("finer and finer spheres come to the sphere's volume and inertia with the square of their edges")
{
    const double radius = 0.7, volume = 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3.0);
    const double moment = 0.4 * volume * radius * radius;
    double before = 1.0;
    for (int times : {3, 4, 5}) {
        const MassProperties body = massProperties(sphere(radius, times), "sphere");
        CHECK(length(body.centre) < 1e-14);
        CHECK(body.volume < volume);
        const double off = frobeniusNorm(body.inertia - moment * Mat3::identity()) / moment;
        CHECK(off < 0.27 * before);
        before = off;
    }
    CHECK(before < 6e-3);
}

TEST_CASE("a body that is moved and turned keeps its volume, and its inertia turns with it")
{
    std::mt19937 random(3);
    const Vec3 size{0.3, 0.02, 0.1};
    for (double far : {1.0, 1000.0}) {
        const Quat rotation = axisAngle(randomPoint(random, -1, 1), 2.0);
        const Vec3 shift = randomPoint(random, -far, far);
        const MassProperties body = massProperties(placed(box(size), rotation, shift), "box");
        const double rounding = 1e-13 * far / 0.02;
        CHECK(body.volume == Approx(6e-4).epsilon(rounding));
        CHECK(distance(body.centre, shift + rotate(rotation, 0.5 * size)) < rounding);
        checkSame(body.inertia, rotated(boxInertia(size), rotation), rounding);
    }
}

TEST_CASE("two boxes in one mesh have the inertia that the parallel axis theorem gives")
{
    const Vec3 size{0.3, 0.02, 0.1}, apart{0.5, 0.1, -0.2};
    const MassProperties body = massProperties(together(box(size), placed(box(size), {}, apart)), "boxes");
    const double volume = 6e-4;
    const Vec3 arm = 0.5 * apart;
    const Mat3 steiner = 2.0 * volume * (lengthSquared(arm) * Mat3::identity() - outer(arm, arm));
    CHECK(body.volume == Approx(2 * volume));
    CHECK(distance(body.centre, 0.5 * size + arm) < 1e-14);
    checkSame(body.inertia, 2.0 * boxInertia(size) + steiner, 1e-13);
}

TEST_CASE("a hollow in a body is taken off")
{
    const Vec3 size{1, 1, 1};
    const TriangleMesh hollow = insideOut(placed(box(0.5 * size), {}, 0.25 * size));
    const MassProperties body = massProperties(together(box(size), hollow), "hollow box");
    CHECK(body.volume == Approx(0.875));
    checkSame(body.inertia, boxInertia(size) - boxInertia(0.5 * size), 1e-13);
}

TEST_CASE("the surface of a tetrahedral mesh has the mesh's volume")
{
    const TetMesh mesh = cubeMesh(4, 5);
    const MassProperties body = massProperties(extractSurface(mesh).mesh, "cube");
    CHECK(body.volume == Approx(volumeOf(mesh)).epsilon(1e-13));
    checkSame(body.inertia, boxInertia({1, 1, 1}), 1e-12);
}

TEST_CASE("a surface with a hole is refused by its first open edge")
{
    TriangleMesh mesh = box({1, 1, 1});
    mesh.triangles.erase(mesh.triangles.begin()); // 0 1 3
    checkRefused(mesh, {"mesh 'm'", "must be a closed surface", "vertices 0 and 1", "one triangle only"});
}

TEST_CASE("a triangle turned against its neighbours is refused by an edge of it")
{
    TriangleMesh mesh = box({1, 1, 1});
    std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
    checkRefused(mesh, {"mesh 'm'", "must be a closed surface", "vertices 0 and 1", "are not oriented alike"});
}

TEST_CASE("the enclosed volume is that of the body, less than nothing inside out, wherever it lies")
{
    CHECK(enclosedVolume(placed(box({1, 2, 3}), {}, {5, -7, 9})) == Approx(6.0));
    CHECK(enclosedVolume(insideOut(box({1, 2, 3}))) == Approx(-6.0));
}

TEST_CASE("a mesh turned inside out, a flat one, and one of parts that cannot be one body, are refused")
{
    checkRefused(insideOut(box({1, 2, 1})), {"mesh 'm'", "must not be inside out", "its volume is -"});
    const TriangleMesh sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}, {}};
    checkRefused(sheet, {"mesh 'm'", "flat", "> 0 m^3"});
    const TriangleMesh other = placed(insideOut(box({0.9, 0.9, 0.9})), {}, {5, 0, 0});
    checkRefused(together(box({1, 1, 1}), other), {"mesh 'm'", "a part of it is inside out"});
}

} // namespace mass_properties_test
