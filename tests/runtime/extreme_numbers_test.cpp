#include "filasofia/filasofia.h"

namespace extreme_numbers_test {

using namespace filasofia;

namespace {

/// The error message that an act is refused with, or empty if it is accepted.
std::string refusal(const std::function<void(Simulation&)>& act)
{
    Simulation sim;
    try {
        act(sim);
        return {};
    } catch (const Error& error) {
        return error.what();
    }
}

std::shared_ptr<const geometry::TetMesh> farBlock(double at)
{
    geometry::TetMesh mesh = *shapes::block({20_mm, 20_mm, 20_mm}, {1, 1, 1});
    for (Vec3& node : mesh.nodes) node = node * at;
    return std::make_shared<const geometry::TetMesh>(mesh);
}

std::shared_ptr<const geometry::TriangleMesh> farSphere(double at)
{
    geometry::TriangleMesh mesh = *shapes::sphere(5_mm, 2);
    for (Vec3& vertex : mesh.vertices) vertex = vertex * at;
    return std::make_shared<const geometry::TriangleMesh>(mesh);
}

} // namespace

TEST_CASE("coordinates of any size are refused by object, field, bound and value, none of which is infinite")
{
    const auto block = shapes::block({20_mm, 20_mm, 20_mm}, {1, 1, 1});
    const auto ball = shapes::sphere(5_mm, 2);
    for (const double far : {1e8, 1e20, 1e60, 1e110, 1e200, 1e300, 1e306}) {
        const Pose away{{far, 0, 0}, {}};
        const auto add = [&](auto def) { return refusal([&](Simulation& sim) { sim.add(def); }); };
        const auto holds = [&](const std::string& said, const char* object, const char* bound) {
            INFO(far << ": " << said);
            CHECK_THAT(said, Catch::StartsWith(object));
            CHECK_THAT(said, Catch::Contains(bound) || Catch::Contains("within 1e+20 m"));
            CHECK_THAT(said, Catch::Contains("got "));
            CHECK_THAT(said, !Catch::Contains("inf") && !Catch::Contains("nan"));
        };
        holds(add(SoftBodyDef{.name = "it", .mesh = farBlock(far)}), "soft body 'it': mesh: node ", "within 10000 m");
        holds(add(SoftBodyDef{.name = "it", .mesh = block, .pose = away}), "soft body 'it': pose: ", "within 10000 m");
        holds(add(RigidBodyDef{.name = "it", .elements = {away}}), "rigid body 'it': elements[0]: ", "within 10000 m");
        holds(add(RigidBodyDef{.name = "it", .mesh = ball, .dynamic = true, .velocity = {far, 0, 0}}),
              "rigid body 'it': velocity", "10000");
        holds(refusal([&](Simulation& sim) { sim.physics().setPose(sim.add(RigidBodyDef{.name = "it"}), away); }),
              "rigid body 'it': ", "within 10000 m");

        // A large surface is allowed, unless its volume overflows a double.
        for (const std::string& said :
             {add(SoftBodyDef{.name = "it", .mesh = block, .collision = {{.mesh = farSphere(far)}}}),
              add(RigidBodyDef{.name = "it", .mesh = farSphere(far), .collision = {{}}}),
              add(RigidBodyDef{.name = "it", .mesh = farSphere(far), .dynamic = true}),
              add(RigidBodyDef{.name = "it", .dynamic = true, .mass = GivenInertia{.centre = {far, 0, 0}}})}) {
            INFO(far << ": " << said);
            CHECK((!said.empty() || far < 1e60));
            CHECK((said.empty() || said.find("body 'it'") < 10));
            CHECK_THAT(said, !Catch::Contains("inf") && !Catch::Contains("nan"));
        }
    }
}

TEST_CASE("a look around coordinates of any size is drawn or refused, and no message has an infinity in it")
{
    for (const double far : {1e8, 1e100, 1e200, 1e300}) {
        const SimulationDef def{.look = {.around = geometry::Box{{-far, -far, -far}, {far, far, far}}}};
        std::string said;
        try {
            Simulation sim(def);
            sim.run({.backend = Backend::Null, .steps = 2});
        } catch (const Error& error) {
            said = error.what();
        }
        INFO(said);
        CHECK_THAT(said, !Catch::Contains("inf") && !Catch::Contains("nan"));
    }
}

} // namespace extreme_numbers_test
