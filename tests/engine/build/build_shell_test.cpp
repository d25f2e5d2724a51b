#include "filasofia/core/error.h"
#include "filasofia/engine/build/build_body.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_server.h"

#include "engine/sheets.h"

namespace build_shell_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

SoftBodyDef sheet(geometry::TriangleMesh mesh = sheetMesh({2, 2}, 0.1, 0.1))
{
    return {.name = "peritoneum", .mesh = shared(std::move(mesh)), .material = ShellMaterial{}};
}

/// What building the body fails with; empty if it does not.
std::string errorOf(const SoftBodyDef& def)
{
    try {
        static_cast<void>(buildBody(def, 1e-3));
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

void checkError(const SoftBodyDef& def, const std::string& part)
{
    const std::string error = errorOf(def);
    INFO(error);
    CHECK(error.find("soft body 'peritoneum'") == 0);
    CHECK(error.find(part) != std::string::npos);
}

} // namespace

TEST_CASE("a mesh of triangles with a shell material becomes a shell")
{
    const auto built = buildBody(sheet(), 1e-3);
    const SoftModel& model = dynamic_cast<BuiltSoftBody&>(*built).body.model;
    CHECK(built->nodeCount() == 9);
    CHECK(model.shell.membranes.size() == 8);
    CHECK(model.shell.bends.size() == 8);
    CHECK(model.surface.size() == 8);
    SoftBodyDef membrane = sheet();
    membrane.material = ShellMaterial{.bendingScale = 0.0};
    CHECK(dynamic_cast<BuiltSoftBody&>(*buildBody(membrane, 1e-3)).body.model.shell.bends.empty());
}

TEST_CASE("a mesh of the wrong kind is refused, and says which material it is for")
{
    SoftBodyDef def = sheet();
    def.material = FemMaterial{};
    checkError(def, "mesh must be a tetrahedral mesh for this material, got a triangle mesh");
    def.material = MassSpringMaterial{};
    checkError(def, "mesh must be a tetrahedral mesh for this material, got a triangle mesh");
    def = sheet();
    def.mesh = shared(tetrahedronMesh());
    checkError(def, "mesh must be a triangle mesh for a ShellMaterial, got a tetrahedral mesh");
    def.mesh = std::string();
    checkError(def, "mesh must name a file or be a mesh, got nothing");
}

TEST_CASE("a triangle mesh of which no shell can be made is refused, with the vertex, the triangle or the edge")
{
    geometry::TriangleMesh mesh = sheetMesh({2, 2}, 0.1, 0.1);
    mesh.vertices.push_back({1, 1, 1});
    checkError(sheet(mesh), "vertex 9 must belong to a triangle");
    mesh = sheetMesh({2, 2}, 0.1, 0.1);
    mesh.vertices[4] = mesh.vertices[0];
    checkError(sheet(mesh), "triangle 0 (0 3 4) must have a height > 1e-04 of its longest edge, got 0");
    mesh = sheetMesh({2, 2}, 0.1, 0.1);
    mesh.triangles.push_back({4, 0, 3});
    checkError(sheet(mesh), "triangle 8 (4 0 3) must differ from triangle 0");
    mesh = sheetMesh({2, 2}, 0.1, 0.1);
    mesh.vertices.push_back({0.05, 0.05, 0.05});
    mesh.triangles.push_back({0, 4, 9});
    checkError(sheet(mesh), "edge 0 4 must belong to 1 or 2 triangles of the shell, got 3");
    mesh = sheetMesh({2, 2}, 0.1, 0.1);
    std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
    checkError(sheet(mesh), "must face the same way");
}

TEST_CASE("a shell that is folded onto itself is refused if it bends, a membrane is not")
{
    geometry::TriangleMesh bag = sheetMesh({2, 1}, 0.1, 0.1);
    for (Vec3& vertex : bag.vertices)
        if (vertex.x > 0.06) vertex = {vertex.x - 0.1, vertex.y, 1e-6};
    const std::string refused = "the two triangles at edge 2 3 must not lie on each other";
    checkError(sheet(bag), refused);
    checkError(sheet(bag), "unless bendingScale is 0, got 3.14");
    SoftBodyDef membrane = sheet(bag);
    membrane.material = ShellMaterial{.bendingScale = 0.0};
    PhysicsServer server(makeNativeEngine());
    const BodyId id = server.add(membrane);
    CHECK_THROWS_WITH(server.setMaterial(id, ShellMaterial{}), Catch::Contains(refused));
}

TEST_CASE("a closed shell must face outwards")
{
    geometry::TriangleMesh ball = *geometry::shapes::sphere(0.05, 1);
    PhysicsServer server(makeNativeEngine());
    server.add(sheet(ball));
    for (geometry::Triangle& t : ball.triangles) std::swap(t[1], t[2]);
    checkError(sheet(ball), "the triangles of a closed shell must face outwards, but it encloses -");
}

TEST_CASE("what a shell cannot do yet is refused")
{
    SoftBodyDef def = sheet();
    def.collision = {{.mesh = geometry::shapes::sphere(0.1, 2)}};
    checkError(def, "collision[0].mesh must be empty with a ShellMaterial");
}

TEST_CASE("a shell material out of its range is refused with field, bound and value")
{
    const auto refused = [](const ShellMaterial& material, const std::string& part) {
        SoftBodyDef def = sheet();
        def.material = material;
        checkError(def, part);
    };
    refused({.youngModulus = 0.0}, "youngModulus must be > 0 Pa, got 0");
    refused({.poissonRatio = 0.5}, "poissonRatio must be in [0, 0.5), got 0.5");
    refused({.thickness = 0.0}, "thickness must be > 0 m, got 0");
    refused({.bendingScale = -1.0}, "bendingScale must be >= 0, got -1");
    refused({.validStrain = 0.0}, "validStrain must be > 0, got 0");
}

TEST_CASE("a command that does not fit a shell is refused")
{
    PhysicsServer server(makeNativeEngine());
    const BodyId id = server.add(sheet());
    CHECK_THROWS_WITH(server.setMaterial(id, ShellMaterial{.thickness = 2e-3}),
                      Catch::Contains("'peritoneum': material.thickness must be 0.001 m") &&
                          Catch::Contains("got 0.002"));
    CHECK_THROWS_WITH(server.setMaterial(id, FemMaterial{}),
                      Catch::Contains("material must be of the kind that the body was made with"));
    CHECK_THROWS_WITH(server.setTissue(id, {.where = Ball{.radius = 1.0}, .youngModulus = 1e4}),
                      Catch::Contains("material must be a FemMaterial, is a ShellMaterial"));
    server.setMaterial(id, ShellMaterial{.youngModulus = 1e4});
    CHECK(server.step(1e-3).flags == 0);
}

} // namespace build_shell_test
