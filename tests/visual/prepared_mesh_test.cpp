#include "little_scene.h"

#include "filasofia/core/error.h"
#include "filasofia/visual/null_backend.h"
#include "filasofia/visual/scene.h"

#include <optional>
#include <thread>

namespace prepared_mesh_test {

using namespace filasofia;
using namespace filasofia::visual;

namespace {

const NullBackend::Body& bodyOf(VisualBody& body)
{
    return dynamic_cast<const NullBackend&>(*body.impl().scene.backend).bodies.at(body.impl().slot);
}

bool sameBytes(const std::vector<PackedFrame>& a, const std::vector<PackedFrame>& b)
{
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](PackedFrame l, PackedFrame r) {
        return l.x == r.x && l.y == r.y && l.z == r.z && l.w == r.w;
    });
}

} // namespace

TEST_CASE("triangles prepared on another thread come out as those of setMesh, to the bit")
{
    for (const int level : {0, 1, 2}) {
        VisualServer server({.backend = Backend::Null});
        VisualBodyDef def = sphereDef();
        def.subdivision = level;
        VisualBody& now = server.add(def);
        VisualBody& later = server.add(def);
        geometry::TriangleMesh cut = sphere(0.05, 1);
        cut.triangles.pop_back();
        std::vector<Vec3> moved = cut.vertices;
        for (Vec3& v : moved) v += Vec3{0.01, 0.02 * v.x, 0};

        now.setMesh({moved, cut.triangles, {}}, cut.vertices);
        std::optional<PreparedMesh> prepared;
        std::thread([&] { prepared.emplace(cut, level, "ball"); }).join();
        CHECK(prepared->rest().vertices == cut.vertices);
        later.adopt(std::move(*prepared), moved);

        const auto &a = bodyOf(now).geometry, &b = bodyOf(later).geometry;
        CHECK(a.rest == b.rest);
        CHECK(a.indices == b.indices);
        CHECK(a.vertices.positions == b.vertices.positions);
        CHECK(sameBytes(a.vertices.frames, b.vertices.frames));
        CHECK(later.vertices()[3] == moved[3]);
        CHECK(later.triangles().size() == cut.triangles.size());
        // It can still be deformed.
        later.setVertices(cut.vertices);
        CHECK(bodyOf(later).geometry.vertices.positions == b.rest);
    }
}

TEST_CASE("a surface that cannot be drawn is refused where it is prepared, and wrong positions where it is adopted")
{
    geometry::TriangleMesh mesh = sphere(0.05, 1);
    CHECK_THROWS_WITH(PreparedMesh(mesh, 4, "ball"), "body 'ball': subdivision must be in [0, 3], got 4");
    mesh.triangles[3][1] = 1000;
    CHECK_THROWS_WITH(PreparedMesh(mesh, 1, "ball"), Catch::Contains("ball"));
    mesh = sphere(0.05, 1);
    mesh.vertices[2].y = NAN;
    CHECK_THROWS_WITH(PreparedMesh(mesh, 1, "ball"), Catch::Contains("vertex 2"));

    VisualServer server({.backend = Backend::Null});
    VisualBody& body = server.add(sphereDef());
    const std::size_t before = body.vertices().size();
    CHECK_THROWS_WITH(body.adopt(PreparedMesh(sphere(0.05, 1), 0, "ball"), std::vector<Vec3>(3)),
                      Catch::Contains("needs one position for each"));
    CHECK(body.vertices().size() == before);
}

TEST_CASE("the stages of a picture add up by the clock that is given, and cost nothing without one")
{
    VisualServer server({.backend = Backend::Null});
    VisualBody& body = server.add(sphereDef());
    const std::vector<Vec3> positions(body.vertices().begin(), body.vertices().end());
    body.setVertices(positions);
    CHECK(server.statistics().stages.upload == 0.0);
    int calls = 0;
    server.timeStages([&calls] { return 1.0 * ++calls; });
    body.setVertices(positions);
    server.render();
    const VisualStages stages = server.statistics().stages;
    CHECK(stages.subdivision == 1.0);
    CHECK(stages.normals == 1.0);
    CHECK(stages.upload == 1.0);
    CHECK(stages.submit == 1.0);
    server.timeStages({});
    body.setVertices(positions);
    CHECK(calls == 6);
}

TEST_CASE("a server knows its own entities, and a transform's life expires with it")
{
    VisualServer server({.backend = Backend::Null}), other({.backend = Backend::Null});
    VisualBody& body = server.add(sphereDef());
    Transform& rig = server.addTransform("rig");
    CHECK(server.has(body));
    CHECK(server.has(rig));
    CHECK(server.has(server.add(LightDef{})));
    CHECK(server.has(server.add(CameraDef{})));
    CHECK_FALSE(other.has(body));
    CHECK_FALSE(server.has(Transform("mine")));
    const auto life = rig.life();
    CHECK_FALSE(life.expired());
    server.remove(rig);
    CHECK(life.expired());
}

} // namespace prepared_mesh_test
