#include "sofa/sofa_stage.h"

#include "filasofia/runtime/assets.h"
#include "filasofia/runtime/simulation.h"
#include "filasofia/sofa/load.h"
#include "filasofia/sofa/tune.h"

#include <sofa/component/statecontainer/MechanicalObject.h>
#include <sofa/simulation/Node.h>

#include <filesystem>
#include <fstream>

namespace load_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

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
    CHECK(server->step(0.01).has(StepFlag::Undone));
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

} // namespace load_test
