#include "filasofia/core/log.h"
#include "filasofia/geometry/mesh_pieces.h"
#include "filasofia/geometry/shapes.h"
#include "physics/fake_engine.h"

namespace mesh_warnings_test {

using namespace filasofia;
using namespace filasofia::physics;
using Catch::Contains;

namespace {

/// The log of adding a body.
template <class Def> std::string logOf(Def def)
{
    std::string lines;
    setLogSink([&](LogLevel, std::string_view line) { lines += text(line, "\n"); });
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    server.add(std::move(def));
    setLogSink({});
    return lines;
}

SoftBodyDef soft(geometry::TetMesh mesh)
{
    return {.name = "organ", .mesh = std::make_shared<const geometry::TetMesh>(std::move(mesh))};
}

/// Two blocks of 1 cm that touch at a face, each with its own nodes; `apart` [m] between them.
geometry::TetMesh twoBlocks(double apart)
{
    geometry::TetMesh mesh = *geometry::shapes::block({0.01, 0.01, 0.01}, {2, 2, 2}), all = mesh;
    for (const Vec3 p : mesh.nodes) all.nodes.push_back(p + Vec3{0.01 + apart, 0.0, 0.0});
    for (geometry::Tetrahedron t : mesh.tetrahedra) {
        for (int& node : t) node += static_cast<int>(mesh.nodes.size());
        all.tetrahedra.push_back(t);
    }
    return all;
}

} // namespace

TEST_CASE("a mesh in pieces, or with doubled nodes, is told once, with its numbers and what to do")
{
    CHECK(logOf(soft(*geometry::shapes::block({0.01, 0.01, 0.01}, {2, 2, 2}))).empty());
    std::string log = logOf(soft(twoBlocks(0.0)));
    CHECK_THAT(log, Contains("soft body 'organ': the mesh has 2 pieces that share no node, and move apart; 9 of its 54 "
                             "nodes lie on others; to join them, read it with join"));
    CHECK(std::ranges::count(log, '\n') == 1);
    log = logOf(soft(twoBlocks(0.001)));
    CHECK_THAT(log, Contains("soft body 'organ': the mesh has 2 pieces that share no node, and move apart; make a body "
                             "of each"));
    geometry::TetMesh seam = twoBlocks(0.0); // joined at one edge of the face only
    const auto nodes = static_cast<int>(seam.nodes.size());
    for (int a = 0; a < nodes / 2; ++a)
        for (int b = nodes / 2; b < nodes; ++b)
            if (distance(seam.nodes[a], seam.nodes[b]) < 1e-9 && seam.nodes[a].y < -0.004) {
                for (geometry::Tetrahedron& t : seam.tetrahedra)
                    for (int& node : t)
                        if (node == b) node = a;
            }
    std::vector<int> numbers(seam.nodes.size(), -1);
    geometry::TetMesh used{.nodes = {}, .tetrahedra = seam.tetrahedra};
    for (geometry::Tetrahedron& t : used.tetrahedra)
        for (int& node : t) {
            if (numbers[node] < 0)
                numbers[node] = static_cast<int>(used.nodes.size()), used.nodes.push_back(seam.nodes[node]);
            node = numbers[node];
        }
    CHECK_THAT(logOf(soft(used)),
               Contains("soft body 'organ': the mesh is open along a seam: 6 of its 51 nodes lie on others"));
}

TEST_CASE("a body with thin elements is told how many, and which is the worst")
{
    const geometry::TetMesh block = *geometry::shapes::block({0.2, 0.002, 0.2}, {4, 4, 4});
    CHECK_THAT(logOf(soft(block)), Contains("soft body 'organ': 384 of 384 tetrahedra are thin: longest edge over "
                                            "smallest height is ") &&
                                       Contains("(at most 40 is advised)") && Contains("make it a shell"));
    CHECK(logOf(soft(*geometry::shapes::block({0.1, 0.01, 0.1}, {4, 4, 4}))).empty());
    CHECK_THAT(logOf(soft(*geometry::shapes::block({0.1, 1e-4, 0.1}, {20, 1, 20}))),
               Contains("2400 of 2400 tetrahedra are thin") && Contains("make it a shell"));
    geometry::TetMesh dented = *geometry::shapes::block({0.1, 0.1, 0.1}, {2, 2, 2});
    for (Vec3& p : dented.nodes)
        if (length(p) < 1e-9) p.y = -0.0497; // near the face below
    CHECK_THAT(logOf(soft(dented)), Contains("(at most 100 is advised)") && !Contains("shell"));
}

TEST_CASE("a body as large as a bridge is told how millimetres are read, wherever it comes from")
{
    const std::string log = logOf(soft(*geometry::shapes::block({20.0, 10.0, 10.0}, {2, 2, 2})));
    CHECK_THAT(log,
               Contains("soft body 'organ': is 24.495 m large; if its coordinates are millimetres, give it a scale of "
                        "0.001 (in a scene \"mesh\": {\"type\": \"tetrahedra\", \"file\": ..., \"scale\": 0.001}; in "
                        "C++ loadTetMesh(file, 1e-3); in Python load_tet_mesh(file, 1e-3))"));
    CHECK_THAT(logOf(SoftBodyDef{.mesh = geometry::shapes::sheet(20.0, 20.0, {2, 2}), .material = ShellMaterial{}}),
               Contains("\"surface\"") && Contains("load_triangle_mesh(file, 1e-3)"));
    CHECK_THAT(logOf(RodBodyDef{.name = "r", .points = {{0, 0, 0}, {20, 0, 0}}, .spacing = 1.0, .radius = 0.1}),
               Contains("rod 'r': is 20 m large; if its coordinates are millimetres, use metres"));
    for (const bool dynamic : {true, false})
        CHECK_THAT(logOf(RigidBodyDef{.mesh = geometry::shapes::box({50, 50, 50}), .dynamic = dynamic}),
                   Contains("rigid body 'rigid body': is 86.603 m large; if its coordinates are millimetres, give it a "
                            "scale of 0.001 (in a scene \"mesh\": {\"type\": \"surface\"") &&
                       Contains("load_triangle_mesh(file, 1e-3)"));
    const auto floor = geometry::shapes::box({20.0, 0.5, 20.0}); // as large as its name says
    CHECK(logOf(RigidBodyDef{.mesh = floor}).empty());
    CHECK_THAT(logOf(RigidBodyDef{.mesh = floor, .dynamic = true}), Contains("is 28.289 m large"));
    CHECK(logOf(RigidBodyDef{.mesh = geometry::shapes::box({1.0, 1.0, 1.0})}).empty());
}

TEST_CASE("a rod that collides is told that its edges are far shorter than its radius, and what to do")
{
    RodBodyDef rod{.name = "silk", .points = {{0, 0, 0}, {1e-3, 0, 0}}, .spacing = 1e-6, .radius = 0.15e-3};
    CHECK(logOf(rod).empty()); // nothing collides
    rod.collision = RodCollision{};
    CHECK_THAT(logOf(rod), Contains("rod 'silk': 1000 of its 1000 edges are shorter than a quarter of its radius, the "
                                    "shortest is 1/150 of it;") &&
                               Contains("give it a spacing of at least 3.75e-05 m"));
    rod.spacing = 0.05e-3;
    CHECK(logOf(rod).empty());
    rod.spacing.reset();
    rod.points = {{0, 0, 0}, {1e-3, 0, 0}, {1.01e-3, 0, 0}, {2e-3, 0, 0}};
    CHECK_THAT(logOf(rod), Contains("rod 'silk': 1 of its 3 edges is shorter than a quarter of its radius"));
}

TEST_CASE("a rod that is twisted by more than half a turn from edge to edge is told how much its edges can follow")
{
    RodBodyDef rod{.name = "silk", .points = {{0, 0, 0}, {0.1, 0, 0}}, .spacing = 0.01};
    rod.twist = -28.0; // nine joints
    CHECK(logOf(rod).empty());
    rod.twist = -30.0;
    CHECK_THAT(logOf(rod), Contains("rod 'silk': twist of -30 rad is more than pi rad from edge to edge; its 10 edges "
                                    "can follow at most 28 rad"));
    rod.points = {{0, 0, 0}, {0.03, 0, 0}, {0.03, 0.03, 0}, {0, 0.03, 0}};
    rod.closed = true; // twelve edges, as many joints
    CHECK(logOf(rod).empty());
    rod.twist = 40.0;
    CHECK_THAT(logOf(rod), Contains("its 12 edges can follow at most 37 rad"));
}

TEST_CASE("a body so light that it would not fall, and a name that cannot be read, are refused")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    SoftBodyDef def{.name = "a", .mesh = oneTetrahedron(), .mass = Density{1e-30}};
    checkError([&] { server.add(def); },
               {"soft body 'a': mass.value must be >= 0.001 kg/m^3, which the arithmetic bears, got 1e-30"});
    def.mass = Density{kLeastDensity};
    server.add(def);
    checkError(
        [&] {
            server.add(RodBodyDef{.name = "r", .points = {{0, 0, 0}, {0.1, 0, 0}}, .density = 1e-4});
        },
        {"rod 'r': density must be >= 0.001 kg/m^3"});
    def.material = FemMaterial{.regions = {{.where = Listed{{0}}, .density = 1e-9}}};
    checkError([&] { server.add(def); }, {"soft body 'a': material.regions[0].density must be >= 0.001 kg/m^3"});
    checkError([&] { server.add(SoftBodyDef{.name = "", .mesh = oneTetrahedron()}); },
               {"soft body: name must have a visible letter"});
    checkError([&] { server.add(RigidBodyDef{.name = "a\tb"}); }, {"rigid body: name must have no control characters"});
    checkError(
        [&] {
            server.add(RodBodyDef{.name = "\xe2\x80\xae", .points = {{0, 0, 0}, {0.1, 0, 0}}});
        },
        {"rod: name must have no marks that turn"});
    const BodyId first = server.add(RigidBodyDef{.name = "twin"}), second = server.add(RigidBodyDef{.name = "twin"});
    CHECK(first != second); // ids tell bodies apart: equal names are legal here, as those of Defs without a name are
    server.remove(first);
    CHECK(server.nameOf(first) == "twin");
    CHECK(server.nameOf(BodyId{77}) == "body 77");
}

TEST_CASE("nodes that were split so that a body can be cut are told, and nobody is asked to join them")
{
    geometry::TetMesh two = *geometry::shapes::block({0.01, 0.01, 0.01}, {2, 2, 2});
    const geometry::TetMesh one = two;
    for (const Vec3 p : one.nodes) two.nodes.push_back(p + Vec3{0.01, 0.01, 0.0}); // they share an edge of 3 nodes
    for (geometry::Tetrahedron t : one.tetrahedra) {
        for (int& node : t) node += static_cast<int>(one.nodes.size());
        two.tetrahedra.push_back(t);
    }
    SoftBodyDef def = soft(geometry::withJoinedNodes(two, "two"));
    CHECK(logOf(def).empty());
    def.dynamicTopology = true;
    CHECK_THAT(logOf(def),
               Contains("soft body 'organ': 3 nodes were added where parts of the mesh touch in an edge or a "
                        "node only") &&
                   Contains("has 2 pieces that share no node, and move apart; make a body"));
    CHECK_THAT(logOf(def), !Contains("to join them"));
    def.mesh = std::make_shared<const geometry::TetMesh>(two); // so it is if a recording is read again
    CHECK_THAT(logOf(def), !Contains("to join them"));
    def.mesh = std::make_shared<const geometry::TetMesh>(twoBlocks(0.0)); // this seam is none of ours
    CHECK_THAT(logOf(def), Contains("to join them"));
}

TEST_CASE("a collision mesh that is far from its tetrahedra is told")
{
    SoftBodyDef organ = soft(*geometry::shapes::block({0.1, 0.1, 0.1}, {2, 2, 2}));
    organ.collision = {{}, {.mesh = geometry::shapes::sphere(0.05)}};
    CHECK(logOf(organ).empty());
    organ.collision[1].mesh = geometry::shapes::sphere(50.0);
    CHECK_THAT(logOf(organ),
               Contains("soft body 'organ': collision[1].mesh is 173.2 m large, and reaches 49.95 m out"));
}

TEST_CASE("a proximity or a thickness that was meant in millimetres is told")
{
    SoftBodyDef organ = soft(*geometry::shapes::block({0.01, 0.01, 0.01}, {2, 2, 2}));
    organ.collision = {{.proximity = 2e-3}};
    CHECK(logOf(organ).empty());
    organ.collision[0].proximity = 0.5;
    CHECK(logOf(organ) ==
          "soft body 'organ': collision[0].proximity is 0.5 m, and the body is 0.01732 m large; if it is "
          "meant in millimetres, write 5e-04\n");
    RigidBodyDef bead{.name = "bead", .mesh = geometry::shapes::sphere(0.5e-3), .collision = {{}}};
    CHECK(logOf(bead).empty()); // the proximity is not its own word
    RigidBodyDef tool{.name = "tool", .mesh = geometry::shapes::sphere(0.01)};
    tool.collision = {{}, {.proximity = 1.0}};
    CHECK_THAT(logOf(tool), Contains("rigid body 'tool': collision[1].proximity is 1 m"));
    SoftBodyDef sheet{
        .name = "sheet", .mesh = geometry::shapes::sheet(0.04, 0.04, {4, 4}), .material = ShellMaterial{}};
    CHECK(logOf(sheet).empty());
    sheet.material = ShellMaterial{.thickness = 0.5};
    CHECK_THAT(logOf(sheet),
               Contains("soft body 'sheet': material.thickness is 0.5 m, and the body is 0.05656 m large"));
}

} // namespace mesh_warnings_test
