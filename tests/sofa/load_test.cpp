#include "sofa/sofa_stage.h"

#include "filasofia/core/log.h"
#include "filasofia/runtime/assets.h"
#include "filasofia/runtime/simulation.h"
#include "filasofia/sofa/load.h"
#include "filasofia/sofa/tune.h"

#include <sofa/component/statecontainer/MechanicalObject.h>
#include <sofa/component/topology/container/dynamic/TetrahedronSetTopologyModifier.h>
#include <sofa/helper/system/FileRepository.h>
#include <sofa/simulation/Node.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace load_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

using Modifier = ::sofa::component::topology::container::dynamic::TetrahedronSetTopologyModifier;

/// A scene file with this content, beside the test.
std::string sceneFile(const std::string& name, const std::string& content)
{
    const std::string file = (std::filesystem::temp_directory_path() / ("filasofia_" + name + ".scn")).string();
    std::ofstream(file) << "<?xml version=\"1.0\"?>\n<Node name=\"root\" dt=\"0.01\" gravity=\"0 -9.81 0\">" << content
                        << "</Node>\n";
    return file;
}

/// A rigid frame that falls, a mass point without elements, and a picture that follows the frame.
const std::string kFalling = R"(
    <DefaultAnimationLoop/>
    <Node name="Frame">
        <EulerImplicitSolver/><CGLinearSolver iterations="25" tolerance="1e-12" threshold="1e-20"/>
        <MechanicalObject template="Rigid3" name="dofs" position="1 2 3 0 0 0 1"/><UniformMass totalMass="2"/>
        <Node name="Skin">
            <OglModel name="Triangle" position="0 0 0  1 0 0  0 1 0" triangles="0 1 2" translation="0 0 1"/>
            <RigidMapping/>
        </Node>
    </Node>
    <Node name="Point"><MechanicalObject name="dofs" position="0 0 0"/></Node>)";

/// A block of tetrahedra whose mesh may change, held at its left side, and a picture of it. The block is 3 x 2 x 2
/// cells.
std::string cuttable()
{
    const auto mesh = bar(3, 2, 2, {0.03, 0.02, 0.02});
    std::ostringstream nodes, elements, held;
    for (std::size_t i = 0; i < mesh->nodes.size(); ++i) {
        nodes << mesh->nodes[i].x << ' ' << mesh->nodes[i].y << ' ' << mesh->nodes[i].z << ' ';
        if (mesh->nodes[i].x == 0.0) held << i << ' ';
    }
    for (const auto& t : mesh->tetrahedra)
        for (const int node : t) elements << node << ' ';
    return R"(<DefaultAnimationLoop/>
        <EulerImplicitSolver rayleighStiffness="0.1" rayleighMass="1"/>
        <CGLinearSolver iterations="100" tolerance="1e-9" threshold="1e-20"/>
        <Node name="Block">
            <TetrahedronSetTopologyContainer name="mesh" position=")" +
           nodes.str() + "\" tetrahedra=\"" + elements.str() + R"("/>
            <TetrahedronSetTopologyModifier name="modifier"/>
            <TetrahedronSetGeometryAlgorithms template="Vec3"/>
            <MechanicalObject name="dofs"/>
            <DiagonalMass massDensity="1000"/>
            <FixedProjectiveConstraint indices=")" +
           held.str() + R"("/>
            <TetrahedralCorotationalFEMForceField youngModulus="20000" poissonRatio="0.3" method="large"/>
            <Node name="Look"><OglModel name="Skin"/><IdentityMapping input="@../dofs" output="@Skin"/></Node>
        </Node>)";
}

/// Removes tetrahedra in the next step.
void carve(PhysicsServer& server, const std::vector<unsigned>& elements)
{
    sofaengine::tune(server, [elements](::sofa::simulation::Node& root, const sofaengine::NodeOf&) {
        auto* modifier = root.getTreeObject<Modifier>();
        REQUIRE(modifier != nullptr);
        modifier->removeTetrahedra({elements.begin(), elements.end()});
    });
}

/// [m^3] What a closed boundary encloses.
double volumeOf(const frame::Boundary& boundary, const std::vector<Vec3>& at)
{
    double volume = 0.0;
    for (const auto& [a, b, c] : boundary.triangles)
        volume += dot(at.at(static_cast<std::size_t>(a)),
                      cross(at.at(static_cast<std::size_t>(b)), at.at(static_cast<std::size_t>(c)))) /
                  6;
    return volume;
}

} // namespace

TEST_CASE("a scene file of SOFA runs: its states and pictures are bodies, by name")
{
    const auto server = serverWith("native", 0.01);
    const auto scene = sofaengine::load(*server, {.file = sceneFile("falling", kFalling), .unit = 0.1});
    CHECK(server->engine().info().name == "sofa");
    CHECK((scene.dt == 0.01 && length(scene.gravity - Vec3{0, -0.981, 0}) < 1e-12));
    REQUIRE(scene.bodies.size() == 2);
    CHECK((scene.bodies[0].name == "Frame/dofs" && !scene.bodies[0].picture));
    CHECK((scene.bodies[1].name == "Frame/Skin/Triangle" && scene.bodies[1].picture));
    CHECK(scene.left == std::vector<std::string>{"Point/dofs"});
    const BodyId frame = scene.body("dofs"), triangle = scene.body("Triangle");
    CHECK_THROWS_WITH(scene.body("nobody"), Catch::Contains("has no body 'nobody', but 'Frame/dofs', 'Frame/Skin"));
    steps(*server, 50, 0.01);
    const double way = 0.1 * 9.81 * 1e-4 * 50 * 51 / 2;
    const auto state = server->latest();
    CHECK(length(state->rigidBody(frame)->poses[0].position - Vec3{0.1, 0.2 - way, 0.3}) < 1e-9);
    CHECK(state->rigidBody(frame)->velocities[0].y == Approx(-0.1 * 9.81 * 0.5).epsilon(1e-6));
    REQUIRE(state->softBody(triangle)->positions.size() == 3);
    CHECK(length(state->softBody(triangle)->positions[1] - Vec3{0.2, 0.2 - way, 0.4}) < 1e-9);
    server->reset();
    server->setGravity({});
    server->step(0.01);
    CHECK(length(server->latest()->rigidBody(frame)->poses[0].position - Vec3{0.1, 0.2, 0.3}) < 1e-9);
}

TEST_CASE("what a picture has for OpenGL is left out without a word, and what nobody knows is told")
{
    std::vector<std::string> lines;
    setLogSink([&](LogLevel, std::string_view line) { lines.emplace_back(line); });
    std::string words = R"(color="red" material="Default" texturename="a.png" texcoords="0 0" normals="0")";
    const bool known = GENERATE(true, false);
    if (!known) words = R"(colour="red")";
    const auto server = serverWith("native", 0.01);
    sofaengine::load(*server,
                     {.file = sceneFile("picture", "<DefaultAnimationLoop/><OglModel name=\"Skin\" " + words +
                                                       R"( position="0 0 0  1 0 0  0 1 0" triangles="0 1 2"/>)")});
    setLogSink({});
    if (known) {
        CHECK(lines.empty());
    } else {
        REQUIRE(lines.size() == 1);
        CHECK_THAT(lines[0], Catch::Contains("colour"));
    }
}

TEST_CASE("what a loaded scene cannot do is refused")
{
    const auto server = serverWith("native", 0.01);
    const auto scene = sofaengine::load(*server, {.file = sceneFile("refused", kFalling)});
    const BodyId frame = scene.body("Frame/dofs");
    CHECK_THROWS_WITH(server->setPose(frame, {}), Catch::Contains("is not available for a loaded scene of SOFA"));
    CHECK_THROWS_WITH(server->add(RigidBodyDef{.name = "mine"}),
                      Catch::Contains("rigid body 'mine': a loaded scene of SOFA has no bodies besides its own"));
    CHECK_THROWS_WITH(sofaengine::load(*server, {.file = sceneFile("twice", kFalling)}),
                      Catch::Contains("must come before all bodies"));
    CHECK_THROWS_WITH(sofaengine::load(*serverWith("native"), {.file = "/nowhere.scn"}),
                      Catch::Contains("/nowhere.scn: no such file"));
    CHECK_THROWS_WITH(sofaengine::load(*serverWith("native"), {.file = sceneFile("typo", "<MechanicalObjekt/>")}),
                      Catch::Contains("SOFA cannot make the component 'MechanicalObjekt'"));
    CHECK_THROWS_AS(sofaengine::load(*serverWith("native"), {.file = sceneFile("broken", "<Node>")}), Error);
    CHECK_THROWS_WITH(sofaengine::load(*serverWith("native"), {.file = "x.scn", .unit = 0.0}),
                      Catch::Contains("unit must be > 0 m"));
    runtime::Simulation sim;
    sofaengine::load(sim.physics(), {.file = sceneFile("engine", kFalling)});
    CHECK_THROWS_WITH(sim.useEngine("native"), Catch::Contains("a loaded scene of SOFA runs with no other engine"));
    sim.useEngine("sofa");
}

TEST_CASE("a loaded scene is tuned, saved and put back when its numbers are none")
{
    const auto server = serverWith("native", 0.01);
    const auto scene = sofaengine::load(*server, {.file = sceneFile("tuned", kFalling)});
    const BodyId frame = scene.body("Frame/dofs");
    steps(*server, 5, 0.01);
    const auto saved = server->save();
    const Vec3 there = server->latest()->rigidBody(frame)->poses[0].position;
    const auto setSpeed = [&](double speed) {
        sofaengine::tune(*server, [=](::sofa::simulation::Node&, const sofaengine::NodeOf& nodeOf) {
            using State = ::sofa::component::statecontainer::MechanicalObject<::sofa::defaulttype::Rigid3Types>;
            auto* state = dynamic_cast<State*>(nodeOf(frame)->getMechanicalState());
            REQUIRE(state != nullptr);
            ::sofa::helper::WriteAccessor v(state->v);
            v[0] = {{speed, 0, 0}, {}};
        });
    };
    setSpeed(std::nan(""));
    CHECK(server->step(0.01).has(StepFlag::TuneRejected));
    CHECK(server->latest()->rigidBody(frame)->poses[0].position.y < there.y);
    server->restore(*saved);
    CHECK(server->latest()->rigidBody(frame)->poses[0].position == there);
    setSpeed(1.0);
    CHECK(server->step(0.01).has(StepFlag::Tuned));
    CHECK(server->latest()->rigidBody(frame)->poses[0].position.x == Approx(there.x + 0.01));
}

TEST_CASE("the scene that comes with the examples falls on its plate, and scenes come and go")
{
    for (int i = 0; i < 20; ++i) {
        const auto server = serverWith("native", 0.005);
        const auto scene = sofaengine::load(*server, {.file = runtime::asset("scenes/jelly.scn")});
        CHECK(scene.bodies.size() == 4);
        steps(*server, i == 0 ? 120 : 2, 0.005);
        const double lowest =
            std::ranges::min(server->latest()->softBody(scene.body("Jelly/dofs"))->positions, {}, &Vec3::y).y;
        CHECK(lowest > -0.012);
        if (i == 0) CHECK(lowest < 0.012);
    }
}

TEST_CASE("a loaded scene may cut its mesh: nodes keep their numbers, and frames have the new boundary")
{
    const auto server = serverWith("native", 0.01);
    const auto scene = sofaengine::load(*server, {.file = sceneFile("cut", cuttable())});
    const BodyId block = scene.body("Block/dofs"), skin = scene.body("Skin");
    server->pause(true);
    server->step(0.01);
    server->pause(false);
    const auto rest = server->latest()->softBody(block)->positions;
    const double whole = 0.03 * 0.02 * 0.02;
    steps(*server, 5, 0.01);
    CHECK(server->latest()->softBody(block)->boundary == nullptr);
    const auto before = server->save();
    std::size_t removed = 0;
    std::uint64_t revision = 0;
    while (removed < 40) { // there are 60: the far end goes first, then what is behind it
        carve(*server, {static_cast<unsigned>(59 - removed), static_cast<unsigned>(58 - removed)});
        removed += 2;
        REQUIRE_FALSE(server->step(0.01).has(StepFlag::Undone));
        const auto frame = server->latest();
        const auto* body = frame->softBody(block);
        REQUIRE(body->boundary != nullptr);
        CHECK(body->boundary->revision == ++revision);
        REQUIRE(body->positions.size() == rest.size());
        CHECK(body->boundary->rest == rest);
        double gone = 0.0;
        const auto mesh = bar(3, 2, 2, {0.03, 0.02, 0.02});
        for (std::size_t t = 60 - removed; t < 60; ++t) gone += geometry::signedVolume(*mesh, static_cast<int>(t));
        CHECK(volumeOf(*body->boundary, rest) == Approx(whole - gone).epsilon(1e-9));
        for (std::size_t t = 0; t < body->boundary->triangles.size(); ++t) {
            const auto [a, b, c] = body->boundary->triangles[t];
            const Vec3 normal = cross(rest[b] - rest[a], rest[c] - rest[a]);
            const double deep = std::abs(dot(normalized(normal), rest[body->boundary->behind[t]] - rest[a]));
            CHECK(deep > 1e-4);
        }
        const auto* picture = frame->softBody(skin);
        REQUIRE(picture->boundary != nullptr);
        for (const auto& triangle : picture->boundary->triangles)
            for (const int corner : triangle) REQUIRE(static_cast<std::size_t>(corner) < picture->positions.size());
        for (const Vec3 each : picture->positions) CHECK(length(each) < 0.1);
    }
    const auto& opened = server->latest()->softBody(block)->boundary->opened;
    CHECK(std::ranges::count(opened, 1) > 0);
    CHECK(std::ranges::count(opened, 0) > 0);

    const auto cut = server->save();
    carve(*server, {0});
    server->step(0.01);
    const auto now = server->latest()->softBody(block)->positions;
    CHECK_THROWS_WITH(server->restore(*cut), Catch::Contains("the scene's meshes are not those of the state"));
    CHECK(server->latest()->softBody(block)->positions == now);
    server->restore(*before);
    CHECK(volumeOf(*server->latest()->softBody(block)->boundary, rest) == Approx(whole).epsilon(1e-9));
    server->step(0.01);
    carve(*server, {59, 58, 57});
    server->step(0.01);
    server->reset();
    server->setGravity({});
    server->step(0.01);
    CHECK(server->latest()->softBody(block)->positions == rest);
    CHECK(volumeOf(*server->latest()->softBody(block)->boundary, rest) == Approx(whole).epsilon(1e-9));
    CHECK(server->latest()->softBody(block)->boundary->revision == 0);
}

TEST_CASE("a tune() that cuts and leaves numbers which are none is rejected, and the rest of the mesh goes on")
{
    const auto server = serverWith("native", 0.01);
    const auto scene = sofaengine::load(*server, {.file = sceneFile("cut_wild", cuttable())});
    const BodyId block = scene.body("Block/dofs");
    server->step(0.01);
    sofaengine::tune(*server, [&](::sofa::simulation::Node& root, const sofaengine::NodeOf& nodeOf) {
        using State = ::sofa::component::statecontainer::MechanicalObject<::sofa::defaulttype::Vec3Types>;
        ::sofa::helper::WriteAccessor x(dynamic_cast<State*>(nodeOf(block)->getMechanicalState())->x);
        x[5] = {std::nan(""), 0, 0};
        root.getTreeObject<Modifier>()->removeTetrahedra({59, 58, 57, 56, 55});
    });
    CHECK(server->step(0.01).has(StepFlag::TuneRejected));
    for (const Vec3 each : server->latest()->softBody(block)->positions) CHECK(length(each) < 0.1);
    CHECK(server->latest()->softBody(block)->boundary != nullptr);
    CHECK(server->step(0.01).flags == 0);
}

TEST_CASE("siblings of the same name are two bodies")
{
    const std::string one = R"(<Node name="Twin"><EulerImplicitSolver/><CGLinearSolver iterations="25" tolerance="1e-12"
        threshold="1e-20"/><MechanicalObject template="Rigid3" name="dofs" position=")";
    const std::string two = R"( 0 0 0 0 0 1"/><UniformMass totalMass="1"/></Node>)";
    const auto server = serverWith("native", 0.01);
    const auto scene = sofaengine::load(
        *server, {.file = sceneFile("twins", "<DefaultAnimationLoop/>" + one + "1" + two + one + "2" + two)});
    REQUIRE(scene.bodies.size() == 2);
    CHECK((scene.bodies[0].name == "Twin/dofs" && scene.bodies[1].name == "Twin/dofs#2"));
    server->step(0.01);
    const auto frame = server->latest();
    CHECK(frame->rigidBody(scene.body("Twin/dofs"))->poses[0].position.x == 1.0);
    CHECK(frame->rigidBody(scene.body("dofs#2"))->poses[0].position.x == 2.0);
}

TEST_CASE("folders of one scene are searched for that scene alone")
{
    namespace system = ::sofa::helper::system;
    const auto data = system::DataRepository.getPaths(), plugins = system::PluginRepository.getPaths();
    const auto folder = std::filesystem::temp_directory_path() / "filasofia_folder";
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "only_here.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const std::string file = sceneFile(
        "folder",
        R"(<DefaultAnimationLoop/><Node name="Skin"><OglModel name="Face" filename="only_here.obj"/></Node>)");
    for (int i = 0; i < 2; ++i) {
        const auto server = serverWith("native", 0.01);
        CHECK(sofaengine::load(*server, {.file = file, .folders = {folder.string(), "/tmp"}}).bodies.size() == 1);
        CHECK(system::DataRepository.getPaths() == data);
        CHECK(system::PluginRepository.getPaths() == plugins);
    }
    CHECK_THROWS_AS(
        sofaengine::load(*serverWith("native"), {.file = sceneFile("broken", "<Node>"), .folders = {folder.string()}}),
        Error);
    CHECK(system::DataRepository.getPaths() == data);
}

} // namespace load_test
