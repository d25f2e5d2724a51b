#include "engine/stage.h"

#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_server.h"

#include <set>

namespace world_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

void addOneOfEach(PhysicsServer& server)
{
    SoftBodyDef def{.mesh = bunnyFile(756), .attachments = {{.nodes = {0, 1, 2}}}};
    server.add(def);
    def.solver = Cholesky{};
    def.pressure = 20;
    server.add(def);
    def.material = MassSpringMaterial{.stiffness = 50, .damping = 0.1};
    server.add(def);
    def.integrator = ExplicitEuler{true};
    server.add(def);
    server.add(RigidBodyDef{});
}

} // namespace

TEST_CASE("two runs of the same input have the same hash at every step, and no two steps have the same hash")
{
    PhysicsServer a(makeNativeEngine()), b(makeNativeEngine());
    addOneOfEach(a);
    addOneOfEach(b);
    std::set<std::uint64_t> hashes;
    for (int i = 0; i < 60; ++i) {
        const double dt = i % 3 ? 0.001 : 0.002;
        if (i == 20) {
            a.setGravity({1, -9, 0});
            b.setGravity({1, -9, 0});
        }
        a.step(dt);
        b.step(dt);
        REQUIRE(a.hash() == b.hash());
        hashes.insert(a.hash());
    }
    CHECK(hashes.size() == 60);
}

TEST_CASE("keeping a log and hashing every step do not change the result")
{
    PhysicsServer quiet(makeNativeEngine()), watched(makeNativeEngine());
    addOneOfEach(quiet);
    addOneOfEach(watched);
    watched.keepLog(true);
    watched.hashEveryStep(true);
    for (int i = 0; i < 20; ++i) {
        quiet.step(0.001);
        watched.step(0.001);
        CHECK(watched.latest()->step == static_cast<std::uint64_t>(i + 1));
        REQUIRE(watched.nextRecord() != nullptr);
        CHECK(watched.nextRecord()->hash == quiet.hash());
        watched.popRecord();
    }
}

TEST_CASE("the hash covers time, gravity, positions and velocities")
{
    Stage stage;
    SoftBodyDef def{.mesh = shared(tetrahedronMesh())};
    stage.add(def);
    stage.add(RigidBodyDef{});
    stage.post(SetGravity{{0, -9.81, 0}});
    stage.run(3, 0.01);
    const std::uint64_t before = stage.world.hash();
    Scene& scene = stage.world.scene();
    const auto nudge = [&](auto& number) {
        const auto old = number;
        number = std::nextafter(number, std::decay_t<decltype(number)>(1e9));
        CHECK(stage.world.hash() != before);
        number = old;
        CHECK(stage.world.hash() == before);
    };
    nudge(scene.time);
    nudge(scene.gravity.z);
    nudge(scene.soft[0].state.pressure);
    for (auto* list : {&scene.soft[0].state.x, &scene.soft[0].state.v})
        for (int axis = 0; axis < 3; ++axis) nudge((*list)[3][axis]);
    nudge(scene.rigid[0].state.poses[0].position.y);
    nudge(scene.rigid[0].state.poses[0].orientation.z);
    ++scene.step;
    CHECK(stage.world.hash() != before);
}

TEST_CASE("the rest of a soft body's state shows in the hash one step later")
{
    using Change = std::function<void(SoftState&)>;
    const std::pair<const char*, Change> changes[] = {
        {"a force", [](SoftState& body) { body.forces[40].y += 1e-6; }},
        {"what the last step changed", [](SoftState& body) { body.dv[40].y += 1e-6; }},
        {"the residual impulse", [](SoftState& body) { body.residual[40].y += 1e-9; }}};
    for (const auto& [what, change] : changes) {
        INFO(what);
        Stage stages[2];
        for (Stage& stage : stages) {
            stage.add(SoftBodyDef{.mesh = bunnyFile(756), .attachments = {{.nodes = {0, 1, 2}}}});
            stage.post(SetGravity{{0, -9.81, 0}});
            stage.run(3, 0.001);
        }
        change(stages[1].soft());
        for (Stage& stage : stages) stage.run(1, 0.001);
        CHECK(stages[0].world.hash() != stages[1].world.hash());
    }
}

TEST_CASE("bodies without contact do not affect each other: each moves as if it were alone")
{
    Stage both, first, second;
    const SoftBodyDef a{.mesh = bunnyFile(756), .attachments = {{.nodes = {0, 1, 2}}}};
    SoftBodyDef b = a;
    b.material = FemMaterial{.youngModulus = 2e3};
    b.solver = Cholesky{};
    both.add(a);
    both.add(b);
    first.add(a);
    second.add(b);
    for (Stage* stage : {&both, &first, &second}) {
        stage->post(SetGravity{{0, -9.81, 0}});
        stage->run(20, 0.005);
    }
    CHECK(both.soft(0).x == first.soft(0).x);
    CHECK(both.soft(1).x == second.soft(0).x);
}

TEST_CASE("pausing freezes every body and time, and going on is as if there had been no pause")
{
    PhysicsServer paused(makeNativeEngine()), straight(makeNativeEngine());
    addOneOfEach(paused);
    addOneOfEach(straight);
    for (int i = 0; i < 10; ++i) paused.step(0.001);
    const std::uint64_t before = paused.hash();
    paused.pause(true);
    for (int i = 0; i < 5; ++i) {
        const StepReport report = paused.step(0.001);
        CHECK(report.dt == 0.0);
        CHECK(report.step == 10);
        CHECK(paused.hash() == before);
    }
    paused.pause(false);
    for (int i = 0; i < 10; ++i) paused.step(0.001);
    for (int i = 0; i < 20; ++i) straight.step(0.001);
    CHECK(paused.hash() == straight.hash());
}

TEST_CASE("a frame shows every body at its place in the engine")
{
    PhysicsServer server(makeNativeEngine(), {.gravity = {0, -10, 0}});
    const BodyId soft = server.add(freeBody(tetrahedronMesh()));
    const BodyId rigid = server.add(RigidBodyDef{.elements = {{{1, 2, 3}, {}}, {{4, 5, 6}, {}}}});
    server.step(0.5);
    CHECK(server.latest()->rigidBody(rigid)->poses[1].position == Vec3{4, 5, 6});
    const Pose there{{7, 8, 9}, axisAngle({0, 1, 0}, 0.5)};
    server.setPose(rigid, there, 1);
    server.setForces(soft, {{0, {1, 0, 0}}});
    server.step(0.5);
    const frame::FrameRef frame = server.latest();
    CHECK(frame->step == 2);
    CHECK(frame->time == 1.0);
    REQUIRE(frame->rigidBody(rigid) != nullptr);
    CHECK(frame->rigidBody(rigid)->poses[0] == Pose{{1, 2, 3}, {}});
    CHECK(frame->rigidBody(rigid)->poses[1].position == there.position);
    CHECK(std::abs(dot(frame->rigidBody(rigid)->poses[1].orientation, there.orientation)) == Approx(1.0));
    REQUIRE(frame->softBody(soft) != nullptr);
    CHECK(frame->softBody(soft)->positions.size() == 4);
    CHECK(frame->softBody(soft)->velocities[0].x > 0.0);
}

TEST_CASE("a pose with a quaternion of any length arrives normalised")
{
    PhysicsServer server(makeNativeEngine());
    const BodyId rigid = server.add(RigidBodyDef{.elements = {{{}, {0.5, 0, 0, 0}}}});
    server.step(0.1);
    CHECK(server.latest()->rigidBody(rigid)->poses[0].orientation == Quat{});
    server.setPose(rigid, {{}, {0, 0.25, 0, 0}});
    server.step(0.1);
    CHECK(server.latest()->rigidBody(rigid)->poses[0].orientation == Quat{0, 1, 0, 0});
}

TEST_CASE("the log keeps the poses of all rigid elements in the order of bodies")
{
    PhysicsServer server(makeNativeEngine());
    server.keepLog(true);
    server.add(RigidBodyDef{.elements = {{{1, 0, 0}, {}}, {{2, 0, 0}, {}}}});
    server.add(RigidBodyDef{.elements = {{{3, 0, 0}, {}}}});
    server.step(0.1);
    const auto& poses = server.nextRecord()->rigidPoses;
    REQUIRE(poses.size() == 3);
    for (int i = 0; i < 3; ++i) CHECK(poses[i].position.x == i + 1);
}

TEST_CASE("a world without bodies steps")
{
    PhysicsServer server(makeNativeEngine());
    CHECK(server.step(0.1).step == 1);
    CHECK(server.latest()->softBodies.empty());
}

TEST_CASE("a removed body is missing from frame and log")
{
    PhysicsServer server(makeNativeEngine());
    const BodyId soft = server.add(freeBody(tetrahedronMesh())), rigid = server.add(RigidBodyDef{});
    server.keepLog(true);
    server.step(0.1);
    server.remove(soft);
    server.remove(rigid);
    CHECK(server.step(0.1).solves.empty());
    CHECK(server.latest()->softBody(soft) == nullptr);
    CHECK(server.latest()->rigidBody(rigid) == nullptr);
    server.popRecord();
    CHECK(server.nextRecord()->rigidPoses.empty());
}

} // namespace world_test
