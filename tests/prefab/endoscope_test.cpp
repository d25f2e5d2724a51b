#include "filasofia/prefab/endoscope.h"

#include "filasofia/core/error.h"
#include "filasofia/core/units.h"

#include <catch2/catch.hpp>

namespace endoscope_test {

using namespace filasofia;
using prefab::Endoscope;
using prefab::EndoscopeDef;
using runtime::Simulation;

namespace {

const Pose kTip = {{0.01, -0.02, 0.03}, axisAngle({0.3, 1.0, -0.2}, 0.7)};

Vec3 viewOf(const Pose& camera) { return rotate(camera.orientation, {0, 0, -1}); }
Vec3 upOf(const Pose& camera) { return rotate(camera.orientation, {0, 1, 0}); }

bool near(Vec3 a, Vec3 b, double tolerance = 1e-12) { return distance(a, b) < tolerance; }

/// The camera's pose in the engine after some steps.
Pose cameraAfter(Simulation& sim, const Endoscope& scope, int steps)
{
    sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps});
    return sim.physics().latest()->rigidBody(scope.body())->poses[Endoscope::kCamera];
}

} // namespace

TEST_CASE("an endoscope's camera looks as far down from its shaft as its inclination says")
{
    for (const double inclination : {0_deg, 12_deg, 30_deg, 70_deg}) {
        Simulation sim;
        const Endoscope scope(sim, {.pose = kTip, .groups = {}, .inclination = inclination});
        const Vec3 expected = rotate(kTip.orientation, {0, -std::sin(inclination), -std::cos(inclination)});
        const Vec3 up = rotate(kTip.orientation, {0, std::cos(inclination), -std::sin(inclination)});
        CHECK(near(viewOf(scope.camera()), expected));
        CHECK(near(upOf(scope.camera()), up));
        CHECK(near(scope.camera().position, transform(kTip, EndoscopeDef{}.lens)));
        CHECK(near(viewOf(cameraAfter(sim, scope, 2)), expected, 1e-5)); // rounded on its way to the engine
    }
}

TEST_CASE("rolling an endoscope sweeps its view about the shaft, rolling its camera turns the picture alone")
{
    Simulation sim;
    Endoscope scope(sim, {.pose = kTip, .groups = {}, .inclination = 30_deg});
    const double angle = 0.4;
    scope.roll(angle);
    const double s = std::sin(30_deg), c = std::cos(30_deg);
    // (0, -s, -c) rotated by the angle about +Z.
    const Vec3 swept = rotate(kTip.orientation, {s * std::sin(angle), -s * std::cos(angle), -c});
    CHECK(near(viewOf(scope.camera()), swept));
    CHECK(near(scope.tip().position, kTip.position));

    const Vec3 before = upOf(scope.camera());
    scope.cameraRoll(0.9);
    CHECK(near(viewOf(scope.camera()), swept));
    CHECK(dot(upOf(scope.camera()), before) == Approx(std::cos(0.9)).epsilon(1e-9));
    CHECK(near(viewOf(cameraAfter(sim, scope, 2)), swept, 1e-5));
}

TEST_CASE("a straight endoscope's camera rolled back as far as the scope was rolled keeps its picture upright")
{
    Simulation sim;
    Endoscope scope(sim, {.pose = kTip, .groups = {}, .inclination = 0.0});
    const Vec3 up = upOf(scope.camera());
    scope.roll(1.1);
    scope.cameraRoll(-1.1);
    CHECK(near(upOf(scope.camera()), up));
}

TEST_CASE("an endoscope's light and camera are where its body is, and its channel moves along")
{
    Simulation sim;
    Endoscope scope(sim, {.groups = {}, .inclination = 30_deg});
    prefab::EndoscopeView view;
    Pose camera, light;
    int pictures = 0;
    sim.dress([&](visual::VisualServer& server) { view = scope.dress(server); });
    sim.show(visual::GuiDef{.renderCallback = [&] {
        camera = view.camera->worldPose();
        light = view.light->worldPose();
        CHECK(view.view->def().effects->endoscope.has_value());
        const auto frame = sim.physics().latest();
        if (frame && frame->step > 5 && ++pictures == 4) sim.finish("seen"); // the first of them may show older states
    }});
    sim.everyStep([&](double) { scope.move(kTip); });
    sim.run({.backend = visual::Backend::Null});
    CHECK(near(camera.position, scope.camera().position, 1e-6));
    CHECK(near(viewOf(light), viewOf(scope.camera()), 1e-6));
    CHECK(distance(light.position, camera.position) < 1_mm);
    CHECK(near(scope.channel().position, transform(kTip, EndoscopeDef{}.channel.position)));
}

TEST_CASE("an endoscope whose surface is no file leaves nothing behind")
{
    Simulation sim;
    CHECK_THROWS_WITH(Endoscope(sim, {.surfaces = {"nowhere.obj"}}), Catch::Contains("nowhere.obj"));
    CHECK(sim.physics().bodies().empty());
    CHECK_NOTHROW(Endoscope(sim));
    CHECK(sim.physics().bodies().size() == 1);
}

TEST_CASE("a wrong endoscope Def is refused with its name, the field and the bound")
{
    Simulation sim;
    CHECK_THROWS_WITH(Endoscope(sim, {.name = "scope", .inclination = 2.0}),
                      Catch::Contains("endoscope 'scope': inclination must be in [0, 1.5]") &&
                          Catch::Contains("got 2"));
    Endoscope scope(sim, {.name = "scope", .groups = {}});
    CHECK_THROWS_WITH(scope.roll(NAN), Catch::Contains("endoscope 'scope': roll must be finite"));
    CHECK_THROWS_WITH(scope.cameraRoll(INFINITY), Catch::Contains("cameraRoll must be finite"));
}

} // namespace endoscope_test
