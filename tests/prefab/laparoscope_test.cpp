#include "filasofia/prefab/laparoscope.h"

#include "filasofia/core/error.h"
#include "filasofia/core/units.h"

#include <catch2/catch.hpp>

namespace laparoscope_test {

using namespace filasofia;
using namespace filasofia::prefab;
using runtime::Simulation;

namespace {

/// Through a wall above, into the body downwards and forwards; up in the picture is up in the world.
const TrocarDef kPort{
    .fulcrum = {0.01, 0.15, 0.1}, .axis = {0, -1, -1}, .up = {0, 1, 0}, .wallStiffness = physics::kHard};

Vec3 viewOf(const Pose& camera) { return rotate(camera.orientation, {0, 0, -1}); }
Vec3 upOf(const Pose& camera) { return rotate(camera.orientation, {0, 1, 0}); }
void run(Simulation& sim, int steps) { sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}); }
double angleBetween(Vec3 a, Vec3 b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

} // namespace

TEST_CASE("a laparoscope looks 0, 30 or 45 degrees down from its shaft, and its roll sweeps the view about it")
{
    for (const double inclination : {0_deg, 30_deg, 45_deg}) {
        Simulation sim;
        Laparoscope scope(sim, {.inclination = inclination, .trocar = kPort});
        const Vec3 shaft = rotate(pivotOf(kPort, scope.def().start).orientation, {0, 0, -1});
        CHECK(angleBetween(viewOf(scope.camera()), shaft) == Approx(inclination).margin(1e-9));
        if (inclination > 0.0) CHECK(viewOf(scope.camera()).y < shaft.y);
        CHECK(std::abs(viewOf(scope.camera()).x) < 1e-12);
        scope.move({.insertion = 0.05, .roll = 90_deg});
        run(sim, 3);
        CHECK(angleBetween(viewOf(scope.camera()), shaft) == Approx(inclination).margin(1e-9));
        // Counter-clockwise seen from behind, what was down is now on the right.
        CHECK(viewOf(scope.camera()).x == Approx(std::sin(inclination)).margin(1e-9));
        const Vec3 seen = viewOf(sim.physics().latest()->rigidBody(scope.body())->poses[Endoscope::kCamera]);
        CHECK(distance(seen, viewOf(scope.camera())) < 1e-5);
    }
}

TEST_CASE("the horizon of a laparoscope stays level whatever its yaw, pitch and roll, unless it is switched off")
{
    for (const double inclination : {0_deg, 30_deg, 45_deg}) {
        Simulation sim;
        Laparoscope scope(sim, {.inclination = inclination, .trocar = kPort});
        for (const TrocarPose& pose : {TrocarPose{.yaw = 0.3, .pitch = -0.1, .insertion = 0.05, .roll = 0.9},
                                       {.yaw = -0.5, .pitch = 0.2, .insertion = 0.08, .roll = -1.4}}) {
            scope.move(pose);
            run(sim, 3);
            const Vec3 right = rotate(scope.camera().orientation, {1, 0, 0});
            CHECK(std::abs(right.y) < 1e-9); // level
            CHECK(upOf(scope.camera()).y > 0.0);
        }
        scope.horizon(false);
        run(sim, 2);
        CHECK(std::abs(rotate(scope.camera().orientation, {1, 0, 0}).y) > 0.3);
    }
}

TEST_CASE("zoom narrows the field of view, and the picture's lens follows")
{
    Simulation sim;
    Laparoscope scope(sim, {.fieldOfView = 60_deg, .trocar = kPort});
    CHECK(scope.fieldOfView() == Approx(60_deg));
    scope.zoom(2.0);
    CHECK(std::tan(0.5 * scope.fieldOfView()) == Approx(0.5 * std::tan(30_deg)));
    EndoscopeView view;
    double seen = 0.0;
    int pictures = 0;
    sim.dress([&](visual::VisualServer& server) { view = scope.dress(server); });
    sim.show(visual::GuiDef{.renderCallback = [&] {
        seen = view.camera->def().verticalFieldOfView;
        if (++pictures == 1) scope.zoom(4.0);
        if (pictures == 4) sim.finish("seen");
    }});
    sim.run({.backend = visual::Backend::Null});
    CHECK(seen == Approx(scope.fieldOfView()));
    CHECK(std::tan(0.5 * seen) == Approx(0.25 * std::tan(30_deg)));
}

TEST_CASE("a wrong laparoscope is refused with its name, the field and the bound")
{
    Simulation sim;
    using Catch::Contains;
    CHECK_THROWS_WITH(Laparoscope(sim, {.name = "scope", .inclination = 2.0}),
                      Contains("laparoscope 'scope': inclination must be in [0, 1.5]") && Contains("got 2"));
    CHECK_THROWS_WITH(Laparoscope(sim, {.name = "scope", .zoom = 0.5}), Contains("zoom must be in [1, 4]"));
    CHECK_THROWS_WITH(Laparoscope(sim, {.name = "scope", .start = {.insertion = -0.1}}),
                      Contains("laparoscope 'scope': start: insertion must be in [0, 0.25] m, got -0.1"));
    Laparoscope scope(sim, {.name = "scope"});
    CHECK_THROWS_WITH(scope.zoom(5.0), Contains("laparoscope 'scope': zoom must be in [1, 4], got 5"));
}

} // namespace laparoscope_test
