#include "filasofia/engine/build/build_body.h"

#include "engine/stage.h"
#include "filasofia/core/log.h"
#include "filasofia/engine/build/build_rigid.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/geometry/surface.h"

#include <limits>
#include <numeric>

namespace build_body_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Everything that is logged while a body is built.
std::string loggedOf(const SoftBodyDef& def)
{
    std::string logged;
    setLogSink([&](LogLevel, std::string_view line) { logged += line; });
    buildBody(def, 1e-3);
    setLogSink({});
    return logged;
}

SoftBodyDef someBody() { return {.name = "liver", .mesh = shared(boxMesh({2, 2, 2}, {1, 1, 1}))}; }

/// The error text from building a body changed by `change`.
template <class Change> std::string refusal(Change change)
{
    SoftBodyDef def = someBody();
    change(def);
    try {
        buildBody(def, 1e-3);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

double totalMass(const SoftBodyDef& def)
{
    Stage stage;
    stage.add(def);
    stage.step(0.0);
    return std::accumulate(stage.model().masses.begin(), stage.model().masses.end(), 0.0);
}

} // namespace

TEST_CASE("the body of these tests is accepted")
{
    CHECK(refusal([](SoftBodyDef&) {}) == "accepted");
    const auto built = buildBody(someBody(), 1e-3);
    CHECK(built->nodeCount() == 27);
}

TEST_CASE("numbers out of their range are refused, and the error names them")
{
    CHECK(refusal([](SoftBodyDef& d) { d.material = FemMaterial{.youngModulus = -1}; }) ==
          "soft body 'liver': material.youngModulus must be > 0 Pa, got -1");
    CHECK(refusal([](SoftBodyDef& d) { d.material = FemMaterial{.poissonRatio = 0.5}; }) ==
          "soft body 'liver': material.poissonRatio must be in [0, 0.5), got 0.5");
    CHECK(refusal([](SoftBodyDef& d) { d.pose.position.z = kNan; }) ==
          "soft body 'liver': pose.position.z must be finite, got nan");
    CHECK(refusal([](SoftBodyDef& d) { d.pose.orientation.x = kNan; }) ==
          "soft body 'liver': pose.orientation.x must be in [-1, 1], got nan");
    CHECK(refusal([](SoftBodyDef& d) { d.pose.orientation.w = 0; }) ==
          "soft body 'liver': pose: orientation must have a length > 1e-06, got 0");
    CHECK(refusal([](SoftBodyDef& d) { d.mass = Density{0}; }) ==
          "soft body 'liver': mass.value must be > 0 kg/m^3, got 0");
    CHECK(refusal([](SoftBodyDef& d) { d.mass = TotalMass{-3}; }) ==
          "soft body 'liver': mass.value must be > 0 kg, got -3");
    CHECK(refusal([](SoftBodyDef& d) {
              d.forces = {{0, {kNan, 0, 0}}};
          }) == "soft body 'liver': forces[0].force.x must be finite, got nan");
    CHECK(refusal([](SoftBodyDef& d) { d.pressure = kNan; }) == "soft body 'liver': pressure must be finite, got nan");
}

TEST_CASE("nodes that the mesh does not have are refused")
{
    CHECK(refusal([](SoftBodyDef& d) { d.attachments = {{.nodes = {26}}}; }) == "accepted");
    CHECK(refusal([](SoftBodyDef& d) {
              d.attachments = {{.nodes = {0}}, {.nodes = {3, 27}}};
          }) == "soft body 'liver': attachments[1].nodes must be in [0, 27), got 27");
    CHECK(refusal([](SoftBodyDef& d) { d.attachments = {{.nodes = {-1}}}; }) ==
          "soft body 'liver': attachments[0].nodes[0] must be >= 0, got -1");
    CHECK(refusal([](SoftBodyDef& d) {
              d.forces = {{27, {1, 0, 0}}};
          }) == "soft body 'liver': forces[0].node must be in [0, 27), got 27");
}

TEST_CASE("an attachment without nodes is refused")
{
    using geometry::Box;
    CHECK(refusal([](SoftBodyDef& d) { d.attachments = {{}}; }) ==
          "soft body 'liver': attachments[0]: must hold at least one node, got none");
    CHECK(refusal([](SoftBodyDef& d) {
              d.attachments = {{.box = Box{{5, 5, 5}, {6, 6, 6}}}};
          }) == "soft body 'liver': attachments[0]: must hold at least one node, got none in its box");
    CHECK(refusal([](SoftBodyDef& d) {
              d.attachments = {{.box = Box{{0, 0, 0}, {1, -1, 1}}}};
          }) == "soft body 'liver': attachments[0].box: high must be >= low in every axis");
}

TEST_CASE("meshes that cannot be simulated are refused, and the error names the body")
{
    const auto nothing = "soft body 'liver': mesh must name a file or be a mesh, got nothing";
    CHECK(refusal([](SoftBodyDef& d) { d.mesh = ""; }) == nothing);
    CHECK(refusal([](SoftBodyDef& d) { d.mesh = std::shared_ptr<const geometry::TetMesh>(); }) == nothing);
    CHECK_THAT(refusal([](SoftBodyDef& d) { d.mesh = shared({}); }), Catch::Contains("liver"));
    CHECK_THAT(refusal([](SoftBodyDef& d) { d.mesh = "no/such/file.msh"; }), Catch::Contains("no/such/file.msh"));
    CHECK_THAT(refusal([](SoftBodyDef& d) {
                   geometry::TetMesh mesh = tetrahedronMesh();
                   std::swap(mesh.nodes[0], mesh.nodes[1]);
                   d.mesh = shared(mesh);
               }),
               Catch::Contains("soft body 'liver': mesh: tetrahedron 0 is inverted"));
    CHECK_THAT(refusal([](SoftBodyDef& d) {
                   geometry::TetMesh mesh = tetrahedronMesh();
                   mesh.nodes[3].x = kNan;
                   d.mesh = shared(mesh);
               }),
               Catch::Contains("node 3 must be finite"));
    CHECK_THAT(refusal([](SoftBodyDef& d) {
                   geometry::TetMesh mesh = tetrahedronMesh();
                   mesh.tetrahedra[0][2] = 4;
                   d.mesh = shared(mesh);
               }),
               Catch::Contains("names node 4"));
}

TEST_CASE("rigid bodies without elements or with an invalid pose are refused")
{
    const auto refusalOf = [](RigidBodyDef def) -> std::string {
        try {
            buildBody(def, 1e-3);
        } catch (const Error& error) {
            return error.what();
        }
        return "accepted";
    };
    CHECK(refusalOf({.name = "forceps"}) == "accepted");
    CHECK(refusalOf({.name = "forceps", .elements = {}}) ==
          "rigid body 'forceps': elements must have at least one entry, got none");
    CHECK(refusalOf({.name = "forceps", .elements = {{}, {{0, kNan, 0}, {}}}}) ==
          "rigid body 'forceps': elements[1].position.y must be finite, got nan");
    CHECK(refusalOf({.name = "forceps", .elements = {{{}, {0, 0, 0, 0}}}}) ==
          "rigid body 'forceps': elements[0]: orientation must have a length > 1e-06, got 0");
}

TEST_CASE("density times volume is the mass, and a total mass is distributed by volume")
{
    SoftBodyDef def{.mesh = shared(boxMesh({3, 2, 4}, {0.3, 0.2, 0.1}, 0.2)), .mass = Density{1200}};
    CHECK(totalMass(def) == Approx(1200 * 0.3 * 0.2 * 0.1).epsilon(1e-12));
    def.mass = TotalMass{7};
    CHECK(totalMass(def) == Approx(7).epsilon(1e-12));
    def.material = MassSpringMaterial{};
    CHECK(totalMass(def) == Approx(7).epsilon(1e-12));

    Stage stage;
    stage.add(SoftBodyDef{.mesh = shared(tetrahedronMesh()), .mass = Density{6}});
    stage.step(0.0);
    for (double mass : stage.model().masses) CHECK(mass == Approx(0.25)); // a quarter of 6 kg/m^3 times 1/6 m^3
}

TEST_CASE("a pose moves the body, and the boxes of attachments are in world coordinates")
{
    Stage stage;
    SoftBodyDef def = someBody();
    def.pose = {{10, 0, 0}, axisAngle({0, 0, 1}, 1.5707963267948966)};
    def.attachments = {{.box = geometry::Box{{9.9, -0.1, -0.1}, {10.1, 0.1, 1.1}}}}; // around the box's edge x = y = 0
    stage.add(def);
    stage.step(0.0);
    const auto mesh = std::get<std::shared_ptr<const geometry::TetMesh>>(def.mesh);
    for (std::size_t i = 0; i < mesh->nodes.size(); ++i) {
        const Vec3 p = mesh->nodes[i];
        CHECK(distance(stage.soft().x[i], {10 - p.y, p.x, p.z}) < 1e-14);
        CHECK(stage.model().pins.hard[i] == (p.x == 0 && p.y == 0));
    }
}

TEST_CASE("a mass-spring body has one spring per edge, at rest in its start position")
{
    Stage stage;
    stage.add(SoftBodyDef{.mesh = shared(tetrahedronMesh()), .material = MassSpringMaterial{.stiffness = 3}});
    stage.step(0.0);
    REQUIRE(stage.model().springs.size() == 6);
    CHECK(stage.model().elements.empty());
    for (const Spring& spring : stage.model().springs) {
        CHECK(spring.stiffness == 3);
        CHECK(spring.restLength == distance(stage.model().rest[spring.nodes[0]], stage.model().rest[spring.nodes[1]]));
    }
}

TEST_CASE("a file and the mesh read from it make the same body")
{
    Stage a, b;
    SoftBodyDef def{.mesh = bunnyFile(756)};
    a.add(def);
    def.mesh = physics::loadMesh(def);
    b.add(def);
    a.run(3, 0.005);
    b.run(3, 0.005);
    CHECK(a.world.hash() == b.world.hash());
}

TEST_CASE("a separate collision mesh on a body that may be cut logs a warning, since it does not open")
{
    const auto warningsFor = [](bool mesh, bool dynamicTopology) {
        SoftBodyDef def = someBody();
        const geometry::TetMesh box = boxMesh({2, 2, 2}, {0.1, 0.1, 0.1});
        def.mesh = shared(box);
        def.collision = {{}};
        if (mesh)
            def.collision[0].mesh = std::make_shared<const geometry::TriangleMesh>(geometry::extractSurface(box).mesh);
        def.dynamicTopology = dynamicTopology;
        return loggedOf(def);
    };
    CHECK(warningsFor(false, true).empty());
    CHECK(warningsFor(true, false).empty());
    CHECK_THAT(warningsFor(true, true),
               Catch::Contains("soft body 'liver': collision[0].mesh: deforms with the body but does not"));
}

TEST_CASE("a needle's tip lies at its collision mesh")
{
    // One that lay 100 mm beside it was moved by tissue that it did not touch, and its states were not finite.
    RigidBodyDef needle{.name = "needle",
                        .collision = {{.mesh = geometry::shapes::tube({{0, 0, 0}, {0, 20e-3, 0}}, 0.4e-3)}}};
    needle.needle = NeedleDef{.line = {{0, 0, 0}, {0, 20e-3, 0}}, .radius = 0.4e-3};
    buildRigid(needle);
    needle.needle->line = {{0.1, 0, 0}, {0.1, 20e-3, 0}};
    CHECK_THROWS_WITH(buildRigid(needle),
                      Catch::StartsWith("rigid body 'needle': needle.line[0], the tip, must lie at the "
                                        "element's collision mesh, from (") &&
                          Catch::EndsWith(" m, got (0.1 0 0) m"));
}

} // namespace build_body_test
