#include "physics/fake_engine.h"

namespace engine_choice_test {

using namespace filasofia;
using namespace filasofia::physics;

namespace {

SoftBodyDef tissue() { return {.name = "tissue", .mesh = oneTetrahedron()}; }

} // namespace

TEST_CASE("an engine refuses a command at its caller, and knows the body that it is for")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    const BodyId body = server.add(tissue());
    const BodyId tool = server.add(RigidBodyDef{.name = "tool"});
    calls.check = [](const Command& command, const BodyDef* def) {
        if (std::holds_alternative<SetPressure>(command)) fail(describeBody(*def), ": no pressure here");
        if (std::holds_alternative<Grasp>(command)) fail(describeBody(*def), ": no grasps here");
        if (std::holds_alternative<Attach>(command)) fail(describeBody(*def), ": nothing is attached here");
        if (std::holds_alternative<SetGravity>(command) && !def) fail("no gravity here");
    };
    checkError([&] { server.setPressure(body, 10.0); }, {"soft body 'tissue': no pressure here"});
    checkError([&] { server.grasp(tool, body); }, {"rigid body 'tool': no grasps here"});
    checkError([&] { server.attach(body, AttachmentDef{.nodes = {0}}); }, {"soft body 'tissue': nothing is attached"});
    checkError([&] { server.setGravity({}); }, {"no gravity here"});
    calls.check = {};
    CHECK(server.attach(body, AttachmentDef{.nodes = {0}}) == AttachmentId{1}); // what was refused took no number
    server.step(1e-3);
    CHECK(calls.commands.size() == 4); // gravity, two bodies, the attachment
}

TEST_CASE("the engine can be replaced before the first step, and builds what waits")
{
    EngineCalls before, after;
    PhysicsServer server = fakeServer(before);
    const BodyId first = server.add(tissue());
    server.remove(server.add(tissue()));
    server.setMaterial(first, FemMaterial{.youngModulus = 5e3});
    int built = 0;
    after.build = [&] { ++built; };
    server.useEngine(std::make_unique<FakeEngine>(after));
    CHECK(built == 3); // two bodies and the material
    server.step(1e-3);
    CHECK(before.commands.empty());
    REQUIRE(after.commands.size() == 5);
    CHECK(command<AddBody>(after, 1).body != nullptr);
    CHECK(command<SetMaterial>(after, 4).body != nullptr);
    checkError([&] { server.useEngine(std::make_unique<FakeEngine>(after)); }, {"after a step"});
}

TEST_CASE("an engine that refuses what waits does not replace the one before")
{
    EngineCalls before, after;
    PhysicsServer server = fakeServer(before);
    const BodyId body = server.add(tissue());
    server.setPressure(body, 10.0);
    SECTION("a body")
    {
        after.build = [] { fail("soft body 'tissue': no tissue here"); };
    }
    SECTION("a command")
    {
        after.check = [](const Command& command, const BodyDef*) {
            if (std::holds_alternative<SetPressure>(command)) fail("no tissue here");
        };
    }
    checkError([&] { server.useEngine(std::make_unique<FakeEngine>(after)); }, {"no tissue here"});
    server.step(1e-3);
    CHECK(before.commands.size() == 3);
    CHECK(after.commands.empty());
}

TEST_CASE("a tune() of one engine is not left to another")
{
    EngineCalls before, after;
    PhysicsServer server = fakeServer(before);
    server.tune([](PhysicsEngine&) {});
    checkError([&] { server.useEngine(std::make_unique<FakeEngine>(after)); }, {"a tune() of the engine before waits"});
}

} // namespace engine_choice_test
