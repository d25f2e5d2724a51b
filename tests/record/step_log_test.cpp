#include "filasofia/record/step_log.h"

#include "filasofia/core/text.h"
#include "filasofia/engine/native.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

using namespace filasofia;

namespace {

physics::SoftBodyDef bunny()
{
    return {.name = "bunny",
            .mesh = FILASOFIA_SOURCE_DIR "/assets/meshes/bunny_756.msh",
            .attachments = {{.box = geometry::Box{{-1, 0.105, -1}, {1, 1, 1}}}}};
}

/// Thirty steps of a scene in which every kind of command happens.
record::StepLog eventfulRun(physics::PhysicsServer& server)
{
    server.keepLog(true);
    server.hashEveryStep(true);
    record::StepLog log;
    BodyId soft = server.add(bunny()), rigid = server.add(physics::RigidBodyDef{.name = "probe"});
    for (int step = 0; step < 30; ++step) {
        switch (step) {
        case 3:
            server.setGravity({0, 0, -9.81});
            break;
        case 5:
            server.setPose(rigid, {{0, 0.1 * step, 0}, {}});
            break;
        case 7:
            server.setMaterial(soft, physics::FemMaterial{.youngModulus = 20e3});
            break;
        case 9:
            server.setForces(soft, {{.node = 3, .force = {0, 0.1, 0}}});
            break;
        case 11:
            server.setPressure(soft, 50.0);
            break;
        case 13:
            server.pause(true);
            break;
        case 15:
            server.pause(false);
            break;
        case 17:
            server.add(bunny());
            break;
        case 20:
            server.reset();
            break;
        case 25:
            server.remove(soft);
            break;
        default:
            break;
        }
        server.step(step % 2 ? 1e-3 : 2e-3);
    }
    log.drain(server);
    return log;
}

} // namespace

TEST_CASE("a recorded run is made again with the same hash at every step")
{
    physics::PhysicsServer server(engine::makeNativeEngine());
    const record::StepLog log = eventfulRun(server);
    CHECK(log.steps().size() == 30);
    CHECK(log.replayable());
    CHECK_FALSE(record::replay(log.steps(), *engine::makeNativeEngine()));
}

TEST_CASE("a replay names the first step that differs")
{
    physics::PhysicsServer server(engine::makeNativeEngine());
    record::StepLog log = eventfulRun(server);
    std::vector<physics::StepRecord> steps = log.take();
    steps[10].report.dt *= 1.0 + 1e-15;
    const auto difference = record::replay(steps, *engine::makeNativeEngine());
    REQUIRE(difference);
    CHECK(difference->step == steps[10].report.step);
    CHECK(difference->recorded != difference->replayed);
}

TEST_CASE("a recording with tune() says that it cannot be made again")
{
    physics::PhysicsServer server(engine::makeNativeEngine());
    server.keepLog(true);
    engine::tune(server, [](engine::Native& native) { native.state.gravity = {}; });
    server.step(1e-3);
    record::StepLog log;
    log.drain(server);
    CHECK_FALSE(log.replayable());
    CHECK_THROWS_WITH(record::replay(log.steps(), *engine::makeNativeEngine()), Catch::Contains("tune()"));
}

TEST_CASE("a log that begins after the first step says that it cannot be made again")
{
    physics::PhysicsServer server(engine::makeNativeEngine());
    server.add(bunny());
    server.step(1e-3);
    server.keepLog(true);
    server.step(1e-3);
    record::StepLog log;
    log.drain(server);
    CHECK_FALSE(log.replayable());
    CHECK_THROWS_WITH(record::replay(log.steps(), *engine::makeNativeEngine()), Catch::Contains("lost"));
}

TEST_CASE("a full log is seen by who reads it")
{
    physics::PhysicsServer server(engine::makeNativeEngine(), {.logLength = 4});
    server.keepLog(true);
    for (int i = 0; i < 4; ++i) CHECK_FALSE(server.step(1e-3).has(physics::StepFlag::RecordLost));
    CHECK(server.step(1e-3).has(physics::StepFlag::RecordLost));
    record::StepLog log;
    log.drain(server);
    CHECK(log.replayable());
    server.step(1e-3);
    log.drain(server);
    CHECK(log.steps().size() == 5);
    CHECK_FALSE(log.replayable());
    CHECK_THROWS_WITH(record::replay(log.steps(), *engine::makeNativeEngine()), Catch::Contains("lost"));
}

TEST_CASE("the step table has a line per step and says when it cannot be written")
{
    const auto file = std::filesystem::temp_directory_path() / text("filasofia_step_table_test_", getpid(), ".csv");
    physics::PhysicsServer server(engine::makeNativeEngine());
    server.keepLog(true);
    server.hashEveryStep(true);
    server.add(bunny());
    std::uint64_t last = 0;
    {
        record::StepTable table(file);
        for (int i = 0; i < 5; ++i) last = server.step(1e-3).step;
        table.drain(server);
    }
    std::ifstream in(file);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    REQUIRE(lines.size() == 6);
    CHECK(lines[0] == "step,time [s],dt [s],flags,iterations,hash");
    CHECK(lines[5].substr(0, 2) == std::to_string(last) + ",");
    std::filesystem::remove(file);
    CHECK_THROWS_WITH(record::StepTable("/no/such/folder/log.csv"), "/no/such/folder/log.csv: cannot be written");
}
