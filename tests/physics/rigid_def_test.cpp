#include "physics/fake_engine.h"

#include <limits>

namespace rigid_def_test {

using namespace filasofia;
using namespace filasofia::physics;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The corner tetrahedron's surface.
std::shared_ptr<const geometry::TriangleMesh> corner()
{
    const geometry::TriangleMesh mesh{
        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}, {}};
    return std::make_shared<const geometry::TriangleMesh>(mesh);
}

RigidBodyDef dynamicBody() { return {.name = "forceps", .mesh = corner(), .dynamic = true}; }

std::string bunnySurface() { return FILASOFIA_SOURCE_DIR "/assets/meshes/bunny.obj"; }

/// Adds a dynamic body changed by `change` and checks that the Error contains every part.
template <class Change> void checkRefused(Change change, const std::vector<std::string>& parts)
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    RigidBodyDef def = dynamicBody();
    change(def);
    checkError([&] { server.add(def); }, parts);
}

} // namespace

TEST_CASE("a rigid body's surface, and its collision meshes are read from their files once, when it is added")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    const BodyId id = server.add(RigidBodyDef{.mesh = bunnySurface(), .collision = {{.mesh = bunnySurface()}, {}}});
    const auto& def = std::get<RigidBodyDef>(*server.def(id));
    using Mesh = std::shared_ptr<const geometry::TriangleMesh>;
    REQUIRE(std::holds_alternative<Mesh>(def.mesh));
    CHECK(std::get<Mesh>(def.mesh)->triangles.size() > 1000);
    REQUIRE(std::holds_alternative<Mesh>(def.collision[0].mesh));
    CHECK(std::get<Mesh>(def.collision[0].mesh)->triangles == std::get<Mesh>(def.mesh)->triangles);
    CHECK(std::get<std::string>(def.collision[1].mesh).empty()); // none: the body's own surface
}

TEST_CASE("a soft body's collision meshes are read when it is added")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    const BodyId id = server.add(SoftBodyDef{.mesh = oneTetrahedron(), .collision = {{.mesh = bunnySurface()}, {}}});
    const auto& def = std::get<SoftBodyDef>(*server.def(id));
    CHECK(std::get<std::shared_ptr<const geometry::TriangleMesh>>(def.collision[0].mesh) != nullptr);
    CHECK(std::get<std::string>(def.collision[1].mesh).empty());
}

TEST_CASE("an invalid surface is refused by the name of the field that asks for it")
{
    checkRefused([](RigidBodyDef& def) { def.mesh = "no_such.obj"; }, {"no_such.obj"});
    checkRefused([](RigidBodyDef& def) { def.mesh = std::shared_ptr<const geometry::TriangleMesh>(); },
                 {"rigid body 'forceps': mesh", "got a null pointer"});
    const auto broken =
        std::make_shared<const geometry::TriangleMesh>(geometry::TriangleMesh{{{0, 0, 0}}, {{0, 1, 2}}, {}});
    checkRefused([&](RigidBodyDef& def) { def.mesh = broken; }, {"rigid body 'forceps': mesh", "names vertex 1"});
    checkRefused(
        [&](RigidBodyDef& def) {
            def.collision = {{}, {.mesh = broken}};
        },
        {"rigid body 'forceps': collision[1].mesh", "names vertex 1"});
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    checkError(
        [&] { server.add(SoftBodyDef{.name = "liver", .mesh = oneTetrahedron(), .collision = {{.mesh = broken}}}); },
        {"soft body 'liver': collision[0].mesh", "names vertex 1"});
}

TEST_CASE("a dynamic body needs a mesh or an inertia")
{
    for (const RigidMass& mass : {RigidMass{Density{}}, RigidMass{TotalMass{}}})
        checkRefused(
            [&](RigidBodyDef& def) {
                def.mesh = "";
                def.mass = mass;
            },
            {"rigid body 'forceps': mass", "mesh", "GivenInertia"});
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    CHECK_NOTHROW(server.add(RigidBodyDef{.dynamic = true, .mass = GivenInertia{}}));
    CHECK_NOTHROW(server.add(RigidBodyDef{}));
}

TEST_CASE("impossible moments of inertia are refused, those of a rod and of a plate are not")
{
    const auto refused = [](GivenInertia given, const std::vector<std::string>& parts) {
        checkRefused([&](RigidBodyDef& def) { def.mass = given; }, parts);
    };
    refused({.moments = {1, 0, 1}}, {"rigid body 'forceps'", "mass.moments", "must be > 0 kg m^2", "got 1 0 1"});
    refused({.moments = {1, 1, -1}}, {"rigid body 'forceps'", "mass.moments", "must be > 0 kg m^2", "got 1 1 -1"});
    refused({.mass = 0}, {"rigid body 'forceps'", "mass.mass", "must be > 0 kg", "got 0"});
    refused({.moments = {1, 1, 2.1}}, {"rigid body 'forceps': mass.moments", "sum of the other two", "1 1 2.1"});
    refused({.moments = {5, 1, 2}}, {"rigid body 'forceps': mass.moments", "sum of the other two", "5 1 2"});
    refused({.axes = {0, 0, 0, 0}}, {"rigid body 'forceps': mass.axes", "orientation", "length", "got 0"});
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    for (Vec3 moments : {Vec3{1e-8, 1, 1}, Vec3{0.1, 0.2, 0.1 + 0.2}, Vec3{0.7, 0.7, 0.7}})
        CHECK_NOTHROW(server.add(RigidBodyDef{.dynamic = true, .mass = GivenInertia{.moments = moments}}));
}

TEST_CASE("an element that does not exist is refused wherever it is named")
{
    checkRefused([](RigidBodyDef& def) { def.elements.clear(); }, {"rigid body 'forceps': elements", "at least one"});
    checkRefused(
        [](RigidBodyDef& def) {
            def.collision = {{}, {.element = 1}};
        },
        {"rigid body 'forceps': collision[1].element", "[0, 1)", "got 1"});
    checkRefused([](RigidBodyDef& def) { def.collision = {{.self = true}}; },
                 {"rigid body 'forceps': collision[0].self must be false", "one element"});
    checkRefused(
        [](RigidBodyDef& def) {
            def.elements.resize(2);
            def.attachments = {{.element = 1}, {.element = 2}};
        },
        {"rigid body 'forceps': attachments[1].element", "[0, 2)", "got 2"});
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    checkError(
        [&] { server.add(SoftBodyDef{.name = "liver", .mesh = oneTetrahedron(), .collision = {{.element = 1}}}); },
        {"soft body 'liver': collision[0].element must be 0", "got 1"});
}

TEST_CASE("a collision model without any mesh is refused on a rigid body")
{
    checkRefused(
        [](RigidBodyDef& def) {
            def.mesh = "";
            def.mass = GivenInertia{};
            def.collision = {{.mesh = corner()}, {}};
        },
        {"rigid body 'forceps': collision[1].mesh", "the body has no mesh of its own"});
}

TEST_CASE("numbers of a rigid body out of their range are refused")
{
    checkRefused([](RigidBodyDef& def) { def.velocity.y = kNan; }, {"forceps", "velocity.y", "must be finite"});
    checkRefused(
        [](RigidBodyDef& def) {
            def.velocity = {8e3, 8e3, 0};
        },
        {"forceps", "velocity", "< 10000", "got 8000 8000 0"});
    checkRefused([](RigidBodyDef& def) { def.angularVelocity.x = -2e4; }, {"angularVelocity", "< 10000", "got -20000"});
    checkRefused([](RigidBodyDef& def) { def.linearDamping = -1; }, {"linearDamping", ">= 0 1/s", "got -1"});
    checkRefused([](RigidBodyDef& def) { def.angularDamping = -1; }, {"angularDamping", ">= 0 1/s", "got -1"});
    checkRefused([](RigidBodyDef& def) { def.friction = -1; }, {"friction", ">= 0", "got -1"});
    checkRefused([](RigidBodyDef& def) { def.mass = Density{0}; }, {"mass.value", "must be > 0 kg/m^3", "got 0"});
}

TEST_CASE("an element's inertia follows from mesh and density, from mesh and mass, or is given")
{
    RigidBodyDef def = dynamicBody();
    def.mass = Density{600.0};
    CHECK(inertiaOf(def).mass == Approx(100.0));
    CHECK(distance(inertiaOf(def).centre, {0.25, 0.25, 0.25}) < 1e-14);
    const Mat3 inertia = inertiaOf(def).inertia;
    def.mass = TotalMass{50.0};
    CHECK(inertiaOf(def).mass == Approx(50.0));
    CHECK(frobeniusNorm(2.0 * inertiaOf(def).inertia - inertia) < 1e-12);
    def.mass = GivenInertia{.mass = 3.0, .centre = {1, 0, 0}, .moments = {2, 3, 4}, .axes = {0.5, 0.5, 0.5, 0.5}};
    CHECK(inertiaOf(def).mass == 3.0);
    CHECK(inertiaOf(def).centre == Vec3{1, 0, 0});
    CHECK(inertiaOf(def).inertia == Mat3::diagonal({4, 2, 3})); // x goes to y, y to z, z to x
    def.dynamic = false;
    CHECK(inertiaOf(def).mass == 0.0);
}

TEST_CASE("the inertia of a surface that is open or inside out is refused")
{
    RigidBodyDef def = dynamicBody();
    geometry::TriangleMesh mesh = *corner();
    mesh.triangles.pop_back();
    def.mesh = std::make_shared<const geometry::TriangleMesh>(mesh);
    checkError([&] { static_cast<void>(inertiaOf(def)); },
               {"rigid body 'forceps': mesh", "must be a closed surface", "vertices 0 and 1"});
    mesh = *corner();
    for (geometry::Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
    def.mesh = std::make_shared<const geometry::TriangleMesh>(mesh);
    checkError([&] { static_cast<void>(inertiaOf(def)); }, {"rigid body 'forceps': mesh", "must not be inside out"});
}

TEST_CASE(
    "a wrench arrives as it was given, one for an element of a body that is not dynamic is an error at the caller")
{
    EngineCalls calls;
    PhysicsServer server = fakeServer(calls);
    RigidBodyDef def = dynamicBody();
    def.elements.resize(2);
    const BodyId body = server.add(def), tool = server.add(RigidBodyDef{.name = "tool"}),
                 soft = server.add(SoftBodyDef{.name = "liver", .mesh = oneTetrahedron()});
    server.setWrench(body, {1, 2, 3}, {4, 5, 6}, 1);
    server.step(0.1);
    const SetWrench& arrived = command<SetWrench>(calls, 4);
    CHECK((arrived.id == body && arrived.element == 1));
    CHECK((arrived.force == Vec3{1, 2, 3} && arrived.torque == Vec3{4, 5, 6}));

    checkError([&] { server.setWrench(tool, {}, {}); }, {"rigid body 'tool'", "must be a dynamic body"});
    checkError([&] { server.setWrench(soft, {}, {}); }, {"soft body 'liver'", "must be a dynamic rigid body"});
    checkError([&] { server.setWrench(BodyId{99}, {}, {}); }, {"body 99", "no such body"});
    checkError([&] { server.setWrench(body, {}, {}, 2); }, {"rigid body 'forceps'", "element", "[0, 2)", "got 2"});
    checkError([&] { server.setWrench(body, {}, {}, -1); }, {"rigid body 'forceps'", "element", "[0, 2)", "got -1"});
    checkError([&] { server.setWrench(body, {0, kNan, 0}, {}); }, {"forceps", "force.y", "must be finite", "got nan"});
    checkError([&] { server.setWrench(body, {}, {0, 0, kNan}); }, {"forceps", "torque.z", "must be finite", "got nan"});
    calls.commands.clear();
    server.step(0.1);
    CHECK(calls.commands.empty());
}

} // namespace rigid_def_test
