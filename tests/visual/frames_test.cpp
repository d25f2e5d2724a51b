#include "little_scene.h"

#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/surface.h"
#include "filasofia/visual/mesh_frames.h"

#include <random>
#include <utility>

namespace frames_test {

using namespace filasofia;
using namespace filasofia::visual;

namespace {

/// The third axis of a packed frame.
Vec3 normalOf(PackedFrame f)
{
    const double x = f.x / 32767.0, y = f.y / 32767.0, z = f.z / 32767.0, w = f.w / 32767.0;
    return {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
}

std::pair<std::vector<Float3>, std::vector<std::uint32_t>> floatsOf(const geometry::TriangleMesh& mesh)
{
    std::vector<Float3> positions;
    std::vector<std::uint32_t> indices;
    for (Vec3 v : mesh.vertices) positions.push_back(toFloat3(v));
    for (const auto& t : mesh.triangles)
        for (int v : t) indices.push_back(std::uint32_t(v));
    return {std::move(positions), std::move(indices)};
}

} // namespace

TEST_CASE("a packed frame gives its normal back")
{
    std::mt19937 random(1);
    std::normal_distribution<double> number;
    for (int i = 0; i < 10000; ++i) {
        const Vec3 n = normalized(Vec3{number(random), number(random), number(random)});
        const PackedFrame frame = packFrame(toFloat3(3.0 * n));
        CHECK(distance(normalOf(frame), n) < 5e-4);
        CHECK(frame.w > 0);
    }
}

TEST_CASE("a packed frame takes the axes, the pole behind and no normal at all")
{
    for (Vec3 n : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1e-4, 0, -1}}) {
        CHECK(distance(normalOf(packFrame(toFloat3(n))), normalized(n)) < 5e-3);
        CHECK(packFrame(toFloat3(n)).w > 0);
    }
    CHECK(distance(normalOf(packFrame({0, 0, 0})), {0, 0, 1}) < 1e-3);
}

TEST_CASE("the normals along the edge of a block do not depend on the diagonals of its faces")
{
    const geometry::TriangleMesh mesh =
        geometry::extractSurface(*geometry::shapes::block({0.06, 0.02, 0.04}, {6, 3, 6})).mesh;
    const auto [positions, indices] = floatsOf(mesh);
    std::vector<Float3> normals;
    vertexNormals(positions, indices, normals);
    int seen = 0;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const Vec3 at = mesh.vertices[i];
        if (at.y < 0.0099 || std::abs(at.z) < 0.0199 || std::abs(at.x) > 0.0299) continue; // on an edge, and no corner
        const Vec3 n = normalized(Vec3{normals[i].x, normals[i].y, normals[i].z});
        CHECK(n.x == Approx(0.0).margin(1e-5));
        CHECK(n.y == Approx(std::sqrt(0.5)).epsilon(1e-4)); // halfway between top and side
        ++seen;
    }
    CHECK(seen == 10);
}

TEST_CASE("a triangle without area has no normal, and slivers do not spoil those beside them")
{
    const std::vector<Float3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5F, 0, 0}, {0.5F, 0, 1e-3F}};
    std::vector<Float3> normals;
    vertexNormals(positions, std::vector<std::uint32_t>{0, 1, 2, 0, 3, 1, 0, 0, 2, 0, 4, 1}, normals);
    CHECK(normals[0].z > 0.9F * std::sqrt(dot(normals[0], normals[0])));
    for (const Float3& each : normals) CHECK(std::isfinite(each.x + each.y + each.z));
}

TEST_CASE("the normals of a sphere point outwards, and its box holds it")
{
    const geometry::TriangleMesh mesh = sphere(0.05, 3);
    const auto [positions, indices] = floatsOf(mesh);
    std::vector<Float3> room;
    const VertexData data = vertexData(positions, indices, room);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        CHECK(dot(normalOf(data.frames[i]), normalized(mesh.vertices[i])) > 0.99);
    CHECK(data.low == Float3{-0.05F, -0.05F, -0.05F});
    CHECK(data.high == Float3{0.05F, 0.05F, 0.05F});
}

} // namespace frames_test
