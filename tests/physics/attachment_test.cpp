#include "physics/fake_engine.h"

#include <limits>

namespace attachment_test {

using namespace filasofia;
using namespace filasofia::physics;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::shared_ptr<const geometry::TriangleMesh> corner()
{
    const geometry::TriangleMesh mesh{
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}, {}};
    return std::make_shared<const geometry::TriangleMesh>(mesh);
}

/// A soft body (1), a tool without a mesh (2), a dynamic body of two elements (3), another tool (4).
struct Fixture {
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    BodyId soft = server.add(SoftBodyDef{.name = "liver", .mesh = oneTetrahedron()});
    BodyId tool = server.add(RigidBodyDef{.name = "tool"});
    BodyId box =
        server.add(RigidBodyDef{.name = "box", .elements = {Pose{}, Pose{}}, .mesh = corner(), .dynamic = true});
    BodyId other = server.add(RigidBodyDef{.name = "other", .mesh = corner()});

    Fixture()
    {
        server.step(0.1);
        calls.commands.clear();
    }
    void refused(const AttachmentDef& def, const std::vector<std::string>& parts)
    {
        checkError([&] { server.attach(soft, def); }, {"soft body 'liver': attachment"});
        checkError([&] { server.attach(soft, def); }, parts);
    }
    void refused(BodyId body, const RigidAttachmentDef& def, const std::vector<std::string>& parts)
    {
        checkError([&] { server.attach(body, def); }, parts);
    }
    /// Checks that nothing of what was refused has left a trace.
    void checkNothingCame()
    {
        server.step(0.1);
        CHECK(calls.commands.empty());
        CHECK(server.attach(soft, AttachmentDef{.nodes = {0}}) == AttachmentId{1});
    }
};

} // namespace

TEST_CASE_METHOD(Fixture, "attachments reach the engine with their ids, as they were given")
{
    const AttachmentId a = server.attach(soft, AttachmentDef{.nodes = {1, 3}, .stiffness = 7, .to = box, .element = 1});
    const AttachmentId b = server.attach(box, RigidAttachmentDef{.element = 1, .points = {{1, 2, 3}}, .to = soft});
    const AttachmentId c = server.grasp(tool, soft, {.stiffness = 5, .breakForce = 6});
    server.release(b);
    CHECK((a == AttachmentId{1} && b == AttachmentId{2} && c == AttachmentId{3}));
    server.step(0.1);
    REQUIRE(calls.commands.size() == 4);
    const auto& first = command<Attach>(calls, 0);
    CHECK((first.id == a && first.body == soft && first.def.to == box && first.def.element == 1));
    CHECK((first.def.nodes == std::vector{1, 3} && first.def.stiffness == 7));
    const auto& second = command<AttachRigid>(calls, 1);
    CHECK((second.id == b && second.body == box && second.def.element == 1 && second.def.to == soft));
    CHECK(second.def.points == std::vector<Vec3>{{1, 2, 3}});
    const auto& third = command<Grasp>(calls, 2);
    CHECK((third.id == c && third.rigid == tool && third.target == soft));
    CHECK((third.def.stiffness == 5 && third.def.breakForce == 6));
    CHECK(command<Release>(calls, 3).id == b);
}

TEST_CASE_METHOD(Fixture, "the attachments of a Def have ids in its order")
{
    server.attach(soft, AttachmentDef{.nodes = {0}});
    const BodyId a =
        server.add(SoftBodyDef{.mesh = oneTetrahedron(), .attachments = {{.nodes = {0}}, {.within = 0.1, .to = box}}});
    const BodyId b = server.add(RigidBodyDef{.mesh = corner(), .dynamic = true, .attachments = {{.to = a}}});
    CHECK(server.attachments(a) == std::vector<AttachmentId>{{2}, {3}});
    CHECK(server.attachments(b) == std::vector<AttachmentId>{{4}});
    CHECK(server.attachments(soft).empty());
    CHECK(server.attach(soft, AttachmentDef{.nodes = {0}}) == AttachmentId{5});
    checkError([&] { static_cast<void>(server.attachments(BodyId{99})); }, {"body 99", "no such body"});
    server.step(0.1);
    CHECK(command<AddBody>(calls, 1).attachments == AttachmentId{2});
}

TEST_CASE_METHOD(Fixture, "an attachment of nothing, or of a node that does not exist, is an error at the caller")
{
    refused({}, {"must name nodes, a box, a ball or another body"});
    refused({.nodes = {4}}, {".nodes", "[0, 4)", "got 4"});
    refused({.nodes = {0, -1}}, {"nodes[1]", ">= 0", "got -1"});
    refused({.box = geometry::Box{{1, 0, 0}, {0, 1, 1}}}, {".box", "high must be >= low"});
    refused({.ball = Ball{{}, 0.0}}, {"ball.radius", "> 0 m", "got 0"});
    refused({.ball = Ball{{0, kNan, 0}, 1.0}}, {"ball.centre.y", "finite"});
    refused({.within = 0.1}, {".within", "`to`"});
    refused({.within = -0.1, .to = box}, {"within", ">= 0 m", "got -0.1"});
    refused({.nodes = {0}, .stiffness = 0.0}, {"stiffness", "N/m", "got 0"});
    refused({.nodes = {0}, .stiffness = kNan}, {"stiffness", "got nan"});
    refused({.nodes = {0}, .breakForce = 0.0}, {"breakForce", "N", "got 0"});
    refused({.nodes = {0}, .breakForce = -1.0}, {"breakForce", "got -1"});
    refused({.nodes = {0}, .pointBreakForce = 0.0}, {"pointBreakForce", "N", "got 0"});
    refused({.nodes = {0}, .pointBreakForce = 1.0}, {".pointBreakForce", "another body", "got none"});
    refused({.nodes = {0}, .cutDistance = -1e-3}, {"cutDistance", "m", "got -0.001"});
    refused({.nodes = {0}, .cutDistance = 1e-3}, {".cutDistance", "another body", "got none"});
    checkNothingCame();
}

TEST_CASE_METHOD(Fixture, "an attachment to no body, to itself or to no element is an error at the caller")
{
    refused({.nodes = {0}, .to = {99}}, {".to: body 99", "no such body"});
    refused({.nodes = {0}, .to = soft}, {".to must name another body", "body 1 itself"});
    refused({.nodes = {0}, .to = box, .element = 2}, {".element", "[0, 2)", "got 2"});
    refused({.nodes = {0}, .to = box, .element = -1}, {"element", ">= 0", "got -1"});
    refused({.nodes = {0}, .element = 1}, {".element must be 0", "got 1"});
    refused({.to = tool}, {"rigid body 'tool'", "mesh"});
    refused({.nodes = {0}, .within = 0.1, .to = tool}, {".within", "rigid body 'tool'", "mesh"});
    const BodyId second = server.add(SoftBodyDef{.mesh = oneTetrahedron()});
    refused({.nodes = {0}, .to = second, .element = 1}, {".element must be 0", "soft"});
    refused({.nodes = {0, 1}, .to = second, .toNodes = {0}}, {".toNodes must have as many nodes", "2, got 1"});
    refused({.nodes = {0}, .to = second, .toNodes = {4}}, {".toNodes must be in [0, 4), got 4"});
    refused({.nodes = {0}, .to = second, .toNodes = {-1}}, {"toNodes[0]", ">= 0", "got -1"});
    refused({.nodes = {0}, .within = 0.1, .to = second, .toNodes = {0}}, {".toNodes", "within must be empty"});
    refused({.nodes = {0}, .to = box, .toNodes = {0}}, {".toNodes needs a soft body"});
    refused({.nodes = {0}, .toNodes = {0}}, {".toNodes needs a soft body"});
    server.remove(second);
    refused({.nodes = {0}, .to = second}, {"no such body"});
    checkError([&] { server.attach(box, AttachmentDef{.nodes = {0}}); }, {"rigid body 'box'", "RigidAttachmentDef"});
    checkError([&] { server.attach(BodyId{99}, AttachmentDef{.nodes = {0}}); }, {"body 99", "no such body"});
    server.step(0.1);
    calls.commands.clear();
    checkNothingCame();
}

TEST_CASE_METHOD(Fixture, "a rigid attachment between kinematic bodies is an error at the caller")
{
    const std::string name = "rigid body 'box': attachment";
    refused(box, {.element = 2}, {name, ".element", "[0, 2)", "got 2"});
    refused(box, {.points = {{}, {0, kNan, 0}}}, {name, "points[1].y", "finite"});
    refused(box, {.points = {{2e4, 0, 0}}}, {name, "points[0]", "10000 m"});
    refused(box, {.stiffness = -1}, {name, "stiffness", "got -1"});
    refused(box, {.breakForce = 0}, {name, "breakForce", "got 0"});
    refused(box, {.to = box}, {name, ".to must name another body"});
    refused(box, {.to = {99}}, {name, ".to: body 99", "no such body"});
    refused(box, {.to = soft, .toElement = 1}, {name, ".toElement must be 0"});
    refused(box, {.to = tool, .toElement = 1}, {name, ".toElement", "[0, 1)", "got 1"});
    refused(box, {.toElement = 1}, {name, ".toElement must be 0", "got 1"});
    refused(tool, {}, {"rigid body 'tool': attachment", "both are kinematic"});
    refused(tool, {.to = other}, {"rigid body 'tool': attachment", "both are kinematic"});
    refused(soft, RigidAttachmentDef{}, {"soft body 'liver'", "AttachmentDef"});
    checkNothingCame();
}

TEST_CASE_METHOD(Fixture,
                 "a grasp of what cannot be grasped, and a release of what never was, are errors at the caller")
{
    checkError([&] { server.grasp(soft, box); }, {"soft body 'liver'", "must be a rigid body to grasp"});
    checkError([&] { server.grasp(tool, tool); }, {"rigid body 'tool': grasp", "another body"});
    checkError([&] { server.grasp(tool, other); }, {"rigid body 'tool': grasp", "both are kinematic"});
    checkError([&] { server.grasp(tool, BodyId{99}); }, {"body 99", "no such body"});
    checkError([&] { server.grasp(BodyId{99}, soft); }, {"body 99", "no such body"});
    checkError([&] { server.grasp(tool, soft, {.stiffness = 0}); }, {"rigid body 'tool': grasp", "stiffness", "got 0"});
    checkError([&] { server.grasp(tool, soft, {.breakForce = kNan}); }, {"grasp", "breakForce", "got nan"});
    const auto refuse = [&](const Mouth& mouth, std::initializer_list<std::string> words) {
        checkError([&] { server.grasp(tool, soft, {.mouth = mouth}); }, words);
    };
    refuse({.element = 1}, {"rigid body 'tool': grasp: mouth.element", "[0, 1)", "got 1"});
    refuse({.forward = {}}, {"grasp: mouth.forward", "length > 0", "got 0 0 0"});
    refuse({.length = 0}, {"mouth.length", "> 0 m", "got 0"});
    checkError([&] { server.release({}); }, {"attachment 0", "no such attachment"});
    checkError([&] { server.release({1}); }, {"attachment 1", "no such attachment"});
    checkNothingCame();
    const AttachmentId id = server.attach(soft, AttachmentDef{.nodes = {0}});
    server.remove(soft);
    CHECK_NOTHROW(server.release(id)); // it was removed with its body
    CHECK_NOTHROW(server.release(id));
}

TEST_CASE_METHOD(Fixture, "a Def's attachments are checked in the same way when the body is added")
{
    const auto soft2 = [&](AttachmentDef def, const std::vector<std::string>& parts) {
        checkError(
            [&] {
                server.add(SoftBodyDef{.name = "bile", .mesh = oneTetrahedron(), .attachments = {{.nodes = {0}}, def}});
            },
            parts);
    };
    soft2({.nodes = {0}, .to = {99}}, {"soft body 'bile': attachments[1].to: body 99", "no such body"});
    soft2({.nodes = {4}, .to = box}, {"soft body 'bile': attachments[1].nodes", "[0, 4)", "got 4"});
    soft2({.within = 1.0}, {"soft body 'bile': attachments[1].within"});
    soft2({}, {"soft body 'bile': attachments[1]", "must name"});
    checkError([&] { server.add(RigidBodyDef{.name = "clip", .attachments = {{}}}); },
               {"rigid body 'clip': attachments[0]", "both are kinematic"});
    checkError(
        [&] {
            server.add(RigidBodyDef{.name = "clip", .mesh = corner(), .dynamic = true, .attachments = {{.to = {5}}}});
        },
        {"rigid body 'clip': attachments[0].to: body 5", "no such body"}); // the body itself is not there yet
    checkNothingCame();
}

} // namespace attachment_test
