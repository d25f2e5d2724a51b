#include "filasofia/runtime/unseen_bodies.h"

#include "filasofia/core/log.h"
#include "filasofia/geometry/shapes.h"

namespace unseen_bodies_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// A ball of 0.1 m whose middle is one metre ahead of a camera that sees from `near` to `far` [m].
struct Scene {
    visual::VisualServer server{{.backend = visual::Backend::Null}};
    visual::VisualBody& ball;
    visual::Camera& camera;
    visual::View& view;
    UnseenBodies unseen = {};

    Scene(double near, double far)
        : ball(server.add(visual::VisualBodyDef{.name = "ball", .mesh = *geometry::shapes::sphere(0.1)})),
          camera(server.add(visual::CameraDef{.name = "scope", .near = near, .far = far})),
          view(server.add(visual::ViewDef{}, camera))
    {
        ball.setPose({{0.2, 0, 0}, {}});
        camera.setPose(visual::lookAt({0.2, 0, 1}, {0.2, 0, 0}));
    }
    /// What is told.
    std::vector<std::string> look()
    {
        std::vector<std::string> lines;
        setLogSink([&](LogLevel, std::string_view line) { lines.emplace_back(line); });
        unseen.look(server);
        setLogSink({});
        return lines;
    }
};

} // namespace

TEST_CASE("a camera that shows no body, because of near and far, is told once", "[unseen]")
{
    Scene scene(0.005, 0.5);
    const std::vector<std::string> lines = scene.look();
    REQUIRE(lines.size() == 1);
    CHECK(lines.front() == "camera 'scope' shows no body: it shows what is 0.005 (near) to 0.5 m (far) ahead, and the "
                           "bodies are at 0.9 to 1.1 m");
    CHECK(scene.look().empty());
    scene.unseen.lookAgain();
    CHECK(scene.look().empty()); // the same camera, though it may have moved
    scene.camera.set({.name = "scope", .near = 0.005, .far = 0.6});
    scene.unseen.lookAgain();
    CHECK(scene.look().size() == 1);

    Scene turned(0.005, 0.5);
    turned.camera.setPose(visual::lookAt({0.2, 0, 1}, {0.2, 0, 2}));
    turned.unseen.wait();
    CHECK(turned.look().empty());
    turned.unseen.lookAgain();
    const std::vector<std::string> behind = turned.look();
    REQUIRE(behind.size() == 1);
    CHECK_THAT(behind.front(), Catch::EndsWith("the bodies are at -1.1 to -0.9 m, behind it"));
}

TEST_CASE("a camera that shows part of a body, or has nothing to show, is not told", "[unseen]")
{
    CHECK(Scene(0.005, 0.91).look().empty());
    CHECK(Scene(1.09, 2.0).look().empty());
    CHECK(Scene(1.11, 2.0).look().size() == 1);
    CHECK(Scene(0.005, 0.89).look().size() == 1);

    Scene hidden(0.005, 0.5);
    hidden.ball.setVisible(false);
    CHECK(hidden.look().empty());
    Scene notDrawn(0.005, 0.5);
    notDrawn.view.setVisible(false);
    CHECK(notDrawn.look().empty());

    Scene scaled(0.005, 0.5); // as large as six balls
    scaled.ball.setScale(6.0);
    CHECK(scaled.look().empty());
}

} // namespace unseen_bodies_test
