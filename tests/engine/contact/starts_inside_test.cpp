#include "engine/sheets.h"
#include "engine/stage.h"

#include "filasofia/core/log.h"
#include "filasofia/geometry/shapes.h"

#include <numbers>

namespace starts_inside_test {

using namespace filasofia;
using namespace filasofia::engine;
namespace shapes = filasofia::geometry::shapes;

namespace {

using Surface = std::shared_ptr<const geometry::TriangleMesh>;

physics::RigidBodyDef rigid(Surface mesh, Vec3 at = {}, bool dynamic = true)
{
    return {.name = dynamic ? "free" : "told",
            .elements = {{at, {}}},
            .mesh = std::move(mesh),
            .dynamic = dynamic,
            .gravity = false,
            .collision = {{}}};
}
physics::SoftBodyDef tissue(Vec3 size, Vec3 at = {})
{
    physics::SoftBodyDef def{.name = "tissue", .mesh = shapes::block(size, {4, 4, 4})};
    def.pose.position = at;
    def.gravity = false;
    def.collision = {{}};
    return def;
}
physics::SoftBodyDef sheet(Vec3 at = {})
{
    physics::SoftBodyDef def{
        .name = "sheet", .mesh = shared(sheetMesh({10, 10}, 0.1, 0.1)), .material = physics::ShellMaterial{}};
    def.pose.position = at + Vec3{-0.05, -0.05, 0};
    def.gravity = false;
    def.collision = {{}};
    return def;
}
Surface cube(double size) { return shapes::box({size, size, size}); }

struct Told {
    int warnings = 0;
    std::string all;
};
/// What is said of two bodies in their first steps, and that they start inside each other.
Told toldOf(const std::vector<physics::BodyDef>& bodies, int steps = 20)
{
    Told told;
    Stage stage;
    for (const physics::BodyDef& each : bodies) stage.add(each);
    setLogSink([&](LogLevel, std::string_view line) {
        told.all += text(line, "\n");
        if (line.find("start inside each other") != std::string_view::npos) ++told.warnings;
    });
    stage.run(steps, 1e-3);
    setLogSink({});
    return told;
}

} // namespace

TEST_CASE("two bodies that start inside each other are named once, whatever they are")
{
    const Surface ball = shapes::sphere(0.02), bar = shapes::box({0.02, 0.1, 0.02}),
                  across = shapes::box({0.02, 0.02, 0.1});
    struct Pair {
        const char* what;
        physics::BodyDef one, two;
        const char* said;
    };
    const char* const apart = "they are pushed apart";
    const char *const stay = "they may stay so", *const part = "they part where";
    for (const Pair& each : std::vector<Pair>{
             {"ball in a ball", rigid(ball, {}, false), rigid(ball, {0.03, 0, 0}), apart},
             {"balls of which both are free", rigid(ball), rigid(ball, {0.02, 0.001, 0}), apart},
             {"balls at one place", rigid(ball), rigid(ball), apart},
             {"ball in a cube", rigid(cube(0.04), {}, false), rigid(ball, {0.03, 0, 0}), apart},
             {"cube in a cube, face on face", rigid(cube(0.04), {}, false), rigid(cube(0.04), {0.03, 0, 0}), stay},
             {"the same, both free", rigid(cube(0.04)), rigid(cube(0.04), {0.02, 0, 0}), stay},
             {"cubes at one place", rigid(cube(0.04)), rigid(cube(0.04)), stay},
             {"a corner in a cube", rigid(cube(0.04)), rigid(cube(0.04), {0.03, 0.02, 0.025}), part},
             {"a cube wholly in a cube", rigid(cube(0.1), {}, false), rigid(cube(0.02), {0.01, 0, 0}), apart},
             {"bars that cross", rigid(bar), rigid(across, {0.01, 0.003, 0.002}), part},
             {"a bar through tissue", tissue({0.04, 0.04, 0.04}), rigid(bar, {0.003, 0, 0.001}), apart},
             {"a cube in tissue", tissue({0.1, 0.1, 0.1}), rigid(cube(0.02), {0.01, 0, 0}),
              "points inside tissue stay"},
             {"tissue in a cube", tissue({0.02, 0.02, 0.02}), rigid(cube(0.1), {0.01, 0, 0}, false), apart},
             {"tissue in tissue", tissue({0.04, 0.04, 0.04}), tissue({0.04, 0.04, 0.04}, {0.03, 0.002, 0.001}), part},
             {"tissue at one place", tissue({0.04, 0.04, 0.04}), tissue({0.04, 0.04, 0.04}), part},
             {"a bar through a sheet", sheet(), rigid(across, {0.003, 0.001, 0}), apart},
             {"tissue through a sheet", sheet(), tissue({0.04, 0.04, 0.04}, {0.003, 0.001, 0}), part},
         }) {
        CAPTURE(each.what);
        const Told told = toldOf({each.one, each.two});
        CAPTURE(told.all);
        CHECK(told.warnings == 1);
        CHECK(told.all.find(text("start inside each other: ", each.said)) != std::string::npos);
        for (const physics::BodyDef* def : {&each.one, &each.two}) {
            const std::string name = std::visit([](const auto& of) { return of.name; }, *def);
            CHECK(told.all.find(text("body '", name, "'")) != std::string::npos);
        }
    }
}

TEST_CASE(
    "a rod whose tube starts in a body, but not its centre line, is named with its radius, unless it only touches")
{
    physics::RodBodyDef rod{.name = "thread", .points = {{-0.1, 5.5e-3, 0}, {0.1, 5.5e-3, 0}}, .spacing = 20e-3};
    rod.gravity = false;
    rod.collision = physics::RodCollision{};
    physics::RigidBodyDef bar = rigid(shapes::capsule(5e-3, 40e-3), {}, false);
    bar.elements = {{{}, axisAngle({1, 0, 0}, std::numbers::pi / 2)}}; // along z, under the middle of the rod
    for (const auto& [radius, said] :
         {std::pair{0.03, "the radius of 'thread' is 30 mm"}, std::pair{0.1, "the radius of 'thread' is 100 mm"}}) {
        rod.radius = radius;
        const Told told = toldOf({bar, rod}, 3);
        CAPTURE(told.all);
        CHECK(told.warnings == 1);
        CHECK(told.all.find(said) != std::string::npos);
    }
    for (const double radius : {0.15e-3, 0.5e-3, 1e-3}) { // apart, touching, pressed in by half
        rod.radius = radius;
        rod.spacing = 2e-3;
        CHECK(toldOf({bar, rod}, 3).warnings == 0);
    }
    physics::RodBodyDef other = rod; // two rods in one line, and crossing so that they touch
    other.name = "other";
    other.points = {{-0.1, 5.6e-3, 0}, {0.1, 5.6e-3, 0}};
    rod.radius = other.radius = 2e-3;
    CHECK(toldOf({rod, other}, 3).warnings == 1);
    other.points = {{0, 9.6e-3, -0.1}, {0, 9.6e-3, 0.1}};
    CHECK(toldOf({rod, other}, 3).warnings == 0);
}

TEST_CASE("bodies with several surfaces are named once")
{
    physics::RigidBodyDef many = rigid(cube(0.04));
    many.collision = {{.mesh = cube(0.04)}, {.mesh = cube(0.03)}, {.mesh = cube(0.02)}};
    CHECK(toldOf({many, rigid(cube(0.02), {0.004, 0.003, 0.002})}).warnings == 1);
}

TEST_CASE("bodies that touch, rest on each other, are near or welded are not named")
{
    const Surface ball = shapes::sphere(0.02);
    for (const double in : {-1e-3, 0.0, 1e-4, 1e-3}) { // [m] what contacts follow
        CAPTURE(in);
        CHECK(toldOf({rigid(ball, {}, false), rigid(ball, {0.04 - in, 0, 0})}).warnings == 0);
        CHECK(toldOf({rigid(cube(0.04), {}, false), rigid(ball, {0.04 - in, 0, 0})}).warnings == 0);
        CHECK(toldOf({rigid(cube(0.04), {}, false), rigid(cube(0.04), {0.04 - in, 0, 0})}).warnings == 0);
        CHECK(toldOf({rigid(cube(0.1), {}, false), rigid(cube(0.02), {0.06 - in, 0.003, 0.001})}).warnings == 0);
        CHECK(toldOf({tissue({0.04, 0.04, 0.04}), rigid(cube(0.04), {0.04 - in, 0, 0})}).warnings == 0);
        CHECK(toldOf({tissue({0.04, 0.04, 0.04}), tissue({0.04, 0.04, 0.04}, {0.04 - in, 0.001, 0})}).warnings == 0);
        if (in <= 0.0) CHECK(toldOf({sheet(), rigid(cube(0.04), {0, 0, 0.02 - in})}).warnings == 0);
    }
    CHECK(toldOf({rigid(cube(0.04), {}, false), rigid(cube(0.04), {0.03, 0, 0}, false)}).warnings == 0); // scenery
    physics::RigidBodyDef welded = rigid(cube(0.04), {0.03, 0, 0});
    welded.attachments = {{.to = {1}}};
    CHECK(toldOf({rigid(cube(0.04), {}, false), welded}).warnings == 0);
}

} // namespace starts_inside_test
