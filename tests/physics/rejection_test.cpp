#include "physics/fake_engine.h"

#include <limits>

namespace rejection_test {

using namespace filasofia;
using namespace filasofia::physics;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// A server with one body of each kind and no queued command; every test ends with nothing having reached the engine.
struct Fixture {
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    BodyId soft = server.add(SoftBodyDef{.name = "liver", .mesh = oneTetrahedron()});
    BodyId rigid = server.add(RigidBodyDef{.name = "forceps", .elements = {Pose{}, Pose{}}});

    Fixture()
    {
        server.step(0.1);
        calls.commands.clear();
    }
    ~Fixture()
    {
        server.step(0.1);
        CHECK(calls.commands.empty());
    }
};

} // namespace

TEST_CASE_METHOD(Fixture, "a command for a body that was removed or never was is an error at the caller")
{
    const auto each = [&](BodyId id) {
        const std::vector<std::string> parts{text("body ", id.value), "no such body"};
        checkError([&] { server.remove(id); }, parts);
        checkError([&] { server.setPose(id, {}); }, parts);
        checkError([&] { server.setMaterial(id, FemMaterial{}); }, parts);
        checkError([&] { server.setForces(id, {}); }, parts);
        checkError([&] { server.setPressure(id, 0); }, parts);
        checkError([&] { static_cast<void>(server.def(id)); }, parts);
    };
    each(BodyId{});
    each(BodyId{99});
    const BodyId gone = server.add(SoftBodyDef{.mesh = oneTetrahedron()});
    server.remove(gone);
    server.step(0.1);
    calls.commands.clear();
    each(gone);
}

TEST_CASE_METHOD(Fixture, "a step's time must be finite and > 0")
{
    for (const double dt : {0.0, -1e-3, kNan, kInf}) checkError([&] { server.step(dt); }, {"step: dt must be > 0 s"});
}

TEST_CASE_METHOD(Fixture, "the bodies are those that were added and not removed")
{
    CHECK(server.bodies() == std::vector{soft, rigid});
    const BodyId gone = server.add(SoftBodyDef{.mesh = oneTetrahedron()});
    CHECK(server.bodies() == std::vector{soft, rigid, gone});
    server.remove(gone);
    CHECK(server.bodies() == std::vector{soft, rigid});
    server.step(0.1);
    calls.commands.clear();
}

TEST_CASE_METHOD(Fixture, "a command for a body of the other kind is an error")
{
    checkError([&] { server.setPose(soft, {}); }, {"soft body 'liver'", "pose", "must be a rigid body"});
    checkError([&] { server.setMaterial(rigid, FemMaterial{}); }, {"rigid body 'forceps'", "material"});
    checkError([&] { server.setForces(rigid, {}); }, {"rigid body 'forceps'", "forces"});
    checkError([&] { server.setPressure(rigid, 1); }, {"rigid body 'forceps'", "pressure"});
    checkError([&] { server.setCutting(soft, false); }, {"soft body 'liver'", "must be a rigid body"});
    checkError([&] { server.setCutting(rigid, false); }, {"rigid body 'forceps'", "no blade to switch", "cutting"});
}

TEST_CASE_METHOD(Fixture, "an invalid pose is an error")
{
    checkError(
        [&] {
            server.setPose(rigid, {{0, kNan, 0}, {}});
        },
        {"rigid body 'forceps'", "position.y", "must be finite", "got nan"});
    checkError(
        [&] {
            server.setPose(rigid, {{}, {1, 0, kNan, 0}});
        },
        {"rigid body 'forceps'", "orientation.y", "must be in [-1, 1]", "got nan"});
    checkError([&] { server.setPose(rigid, {{}, {0, 0, 0, 0}}); }, {"rigid body 'forceps'", "orientation", "got 0"});
    checkError([&] { server.setPose(rigid, {}, 2); }, {"rigid body 'forceps'", "element", "[0, 2)", "got 2"});
    checkError([&] { server.setPose(rigid, {}, -1); }, {"rigid body 'forceps'", "element", "[0, 2)", "got -1"});
}

TEST_CASE_METHOD(Fixture, "gravity that is not finite, or absurd, is an error")
{
    checkError([&] { server.setGravity({0, kInf, 0}); }, {"gravity", "must be finite", "inf"});
    checkError([&] { server.setGravity({kNan, 0, 0}); }, {"gravity", "must be finite", "nan"});
    checkError(
        [&] {
            server.setGravity({0, -1e30, 0});
        },
        {"physics server: gravity.y must be in [-100000, 100000] m/s^2, got -1e+30"});
}

TEST_CASE_METHOD(Fixture, "a material out of its range, or of the other kind, is an error")
{
    checkError([&] { server.setMaterial(soft, FemMaterial{.youngModulus = -3}); },
               {"soft body 'liver'", "youngModulus", "must be > 0 Pa", "got -3"});
    checkError([&] { server.setMaterial(soft, FemMaterial{.poissonRatio = 0.5}); },
               {"soft body 'liver'", "poissonRatio", "[0, 0.5)", "got 0.5"});
    checkError([&] { server.setMaterial(soft, MassSpringMaterial{}); }, {"soft body 'liver'", "material", "kind"});
}

TEST_CASE_METHOD(Fixture, "a force on a node that does not exist, or one that is not finite, is an error")
{
    checkError([&] { server.setForces(soft, {{0, {}}, {4, {}}}); }, {"liver", "forces[1].node", "[0, 4)", "got 4"});
    checkError([&] { server.setForces(soft, {{-1, {}}}); }, {"liver", "forces[0]", "node", ">= 0", "got -1"});
    checkError(
        [&] {
            server.setForces(soft, {{0, {0, 0, kInf}}});
        },
        {"liver", "forces[0]", "force.z", "must be finite", "got inf"});
}

TEST_CASE_METHOD(Fixture, "a pressure that is not finite is an error")
{
    checkError([&] { server.setPressure(soft, kNan); }, {"soft body 'liver'", "pressure", "must be finite", "got nan"});
}

TEST_CASE_METHOD(Fixture, "a pressure beyond all materials is an error")
{
    checkError([&] { server.setPressure(soft, 1e300); },
               {"soft body 'liver': pressure must be in [-1e+13, 1e+13] Pa, got 1e+300"});
}

TEST_CASE("a server def out of its range is an error")
{
    EngineCalls calls;
    checkError([&] { fakeServer(calls, {.gravity = {0, kNan, 0}}); }, {"physics server", "gravity.y", "finite", "nan"});
    checkError([&] { fakeServer(calls, {.logLength = 0}); }, {"physics server", "logLength", "[1, 1000000]", "got 0"});
}

TEST_CASE_METHOD(
    Fixture, "other threads continue while a material is built, and an error results if its body was removed meanwhile")
{
    const BodyId gone = server.add(SoftBodyDef{.name = "bile", .mesh = oneTetrahedron()});
    calls.build = [&] { server.remove(gone); };
    checkError([&] { server.setMaterial(gone, FemMaterial{}); }, {text("body ", gone.value), "no such body"});
    calls.build = {};
    server.step(0.1);
    REQUIRE(calls.commands.size() == 2); // the body was added and removed
    calls.commands.clear();
}

} // namespace rejection_test
