#include "filasofia/core/error.h"
#include "filasofia/visual/orbit_camera.h"
#include "filasofia/visual/transform.h"

namespace orbit_camera_test {

using namespace filasofia;
using namespace filasofia::visual;
using namespace filasofia::event;

namespace {

constexpr double kPi = std::numbers::pi;

/// A cube of 2 m around (1, 0, 0), seen from 4 m in front of its centre, in a picture of 800 x 600.
OrbitDef cube() { return {.around = {{0, -1, -1}, {2, 1, 1}}, .start = {{1, 0, 4}, {}}, .width = 800, .height = 600}; }

bool button(OrbitCamera& camera, MouseButton which, bool pressed, Modifiers held = {})
{
    MouseButtonEvent event;
    event.button = which;
    event.pressed = pressed;
    event.modifiers = held;
    return camera.handle(event);
}

bool move(OrbitCamera& camera, double dx, double dy)
{
    MouseMoveEvent event;
    event.dx = dx;
    event.dy = dy;
    return camera.handle(event);
}

void drag(OrbitCamera& camera, MouseButton which, double dx, double dy, Modifiers held = {})
{
    button(camera, which, true, held);
    move(camera, dx, dy);
    button(camera, which, false, held);
}

bool wheel(OrbitCamera& camera, double notches)
{
    MouseWheelEvent event;
    event.dy = notches;
    return camera.handle(event);
}

bool key(OrbitCamera& camera, KeyCode code)
{
    KeyEvent event;
    event.key = code;
    event.pressed = true;
    return camera.handle(event);
}

/// The place of a world point in the picture, in [px] from its centre, right and up.
std::array<double, 2> inPicture(const OrbitCamera& camera, const OrbitDef& def, Vec3 point)
{
    const Vec3 p = transform(inverse(camera.pose()), point);
    const double scale = 0.5 * def.height / std::tan(0.5 * def.verticalFieldOfView);
    return {scale * p.x / -p.z, scale * p.y / -p.z};
}

} // namespace

TEST_CASE("until it is moved an orbit camera is exactly where it started, also one that is rolled")
{
    OrbitDef def = cube();
    def.start.orientation = axisAngle({0, 0, 1}, 0.3);
    OrbitCamera camera(def);
    CHECK(camera.pose() == def.start);
    CHECK_FALSE(move(camera, 50, 20)); // no button is pressed
    CHECK(camera.pose() == def.start);
    CHECK(camera.distance() == Approx(4.0));
    CHECK(distance(camera.target(), {1, 0, 0}) < 1e-12);
}

TEST_CASE("a left drag turns about the target: half a turn for the height of the picture")
{
    OrbitCamera camera(cube());
    drag(camera, MouseButton::Left, 300, 0); // the scene moves right, so the camera moves left
    CHECK(distance(camera.pose().position, {-3, 0, 0}) < 1e-12);
    drag(camera, MouseButton::Left, -300, 100);
    CHECK(distance(camera.pose().position, {1, 4 * std::sin(kPi / 6), 4 * std::cos(kPi / 6)}) < 1e-12);
    CHECK(distance(camera.target(), {1, 0, 0}) < 1e-12);
    const auto middle = inPicture(camera, cube(), camera.target());
    CHECK(std::abs(middle[0]) < 1e-9);
    CHECK(std::abs(middle[1]) < 1e-9);
}

TEST_CASE("it never tips over at the poles, and stands upright everywhere")
{
    OrbitCamera camera(cube());
    for (const double way : {5000.0, -10000.0, 700.0, 333.0}) {
        drag(camera, MouseButton::Left, 77, way);
        const Mat3 axes = toMat3(camera.pose().orientation);
        CHECK(axes.column(1).y > 0.017); // upright: sin of the degree that remains to the pole
        CHECK(std::abs(axes.column(0).y) < 1e-12);
        CHECK(camera.distance() == Approx(4.0));
    }
}

TEST_CASE("a shift keeps what is at the target's depth under the mouse")
{
    for (const auto& [which, held] :
         {std::pair{MouseButton::Middle, Modifiers{}}, {MouseButton::Left, {.shift = true}}}) {
        OrbitCamera camera(cube());
        drag(camera, MouseButton::Left, 40, -25);
        const Vec3 grabbed = camera.target();
        drag(camera, which, 120, 45, held);
        const auto now = inPicture(camera, cube(), grabbed);
        CHECK(now[0] == Approx(120));
        CHECK(now[1] == Approx(-45)); // the mouse counts downwards
    }
}

TEST_CASE("the wheel goes nearer and farther by the same share, within the scene's scale")
{
    const double radius = std::sqrt(3.0);
    OrbitCamera camera(cube());
    CHECK(wheel(camera, 1));
    CHECK(camera.distance() == Approx(4.0 * OrbitCamera::kNotch));
    wheel(camera, -1);
    CHECK(camera.distance() == Approx(4.0));
    wheel(camera, 1000);
    CHECK(camera.distance() == Approx(0.1 * radius));
    wheel(camera, -1000);
    CHECK(camera.distance() == Approx(10.0 * radius));
    CHECK(isFinite(camera.pose()));
}

TEST_CASE("a drag shifts the target no farther than the scene is large")
{
    OrbitCamera camera(cube());
    for (int i = 0; i < 20; ++i) drag(camera, MouseButton::Middle, 5000, -3000);
    CHECK(distance(camera.target(), {1, 0, 0}) == Approx(2.0 * std::sqrt(3.0)));
}

TEST_CASE("F shows all of the scene and no more, in a wide picture and in a narrow one")
{
    for (const int width : {800, 300}) {
        OrbitDef def = cube();
        def.width = width;
        OrbitCamera camera(def);
        drag(camera, MouseButton::Middle, 200, 100);
        drag(camera, MouseButton::Left, 10, 70);
        wheel(camera, 5);
        CHECK(key(camera, KeyCode::F));
        CHECK(camera.target() == Vec3{1, 0, 0});
        // The sphere's rim, seen from the camera, touches the nearer edge of the picture.
        const double half = std::atan(std::tan(kPi / 6) * std::min(1.0, width / 600.0));
        CHECK(camera.distance() == Approx(std::sqrt(3.0) / std::sin(half)));
    }
}

TEST_CASE("F frames the scene where it is now, an empty scene changes nothing")
{
    OrbitCamera camera(cube());
    camera.setScene({{9, -1, -1}, {11, 1, 1}});
    camera.setScene({});
    camera.setScene({{3, 3, 3}, {3, 3, 3}});
    camera.setScene({{NAN, 0, 0}, {1, 1, 1}});
    key(camera, KeyCode::F);
    CHECK(camera.target() == Vec3{10, 0, 0});
}

TEST_CASE("Home goes back to the start, to the bit")
{
    OrbitDef def = cube();
    def.start.orientation = axisAngle({1, 2, 3}, 0.1);
    OrbitCamera camera(def);
    drag(camera, MouseButton::Left, 33, 44);
    wheel(camera, -3);
    CHECK_FALSE(camera.pose() == def.start);
    CHECK(key(camera, KeyCode::Home));
    CHECK(camera.pose() == def.start);
}

TEST_CASE("the size of the window is the picture's")
{
    OrbitCamera camera(cube());
    WindowEvent resized;
    resized.width = 500;
    resized.height = 300;
    CHECK_FALSE(camera.handle(resized));
    drag(camera, MouseButton::Left, 150, 0);
    CHECK(distance(camera.pose().position, {-3, 0, 0}) < 1e-12);
}

TEST_CASE("events that are not for the camera are left to others")
{
    OrbitCamera camera(cube());
    CHECK_FALSE(button(camera, MouseButton::Right, true));
    CHECK_FALSE(move(camera, 10, 10));
    CHECK_FALSE(button(camera, MouseButton::Left, true, {.control = true}));
    CHECK_FALSE(button(camera, MouseButton::Left, false)); // the press was taken by a Gui
    CHECK_FALSE(key(camera, KeyCode::Space));
    CHECK_FALSE(wheel(camera, 0));
    CHECK(camera.pose() == cube().start);
    CHECK(button(camera, MouseButton::Left, true));
    CHECK_FALSE(button(camera, MouseButton::Middle, true)); // one drag at a time
    WindowEvent away;
    away.kind = WindowEvent::Kind::FocusLost;
    away.width = 800;
    away.height = 600;
    camera.handle(away);
    CHECK_FALSE(move(camera, 10, 10));
}

TEST_CASE("an orbit camera refuses an empty scene and limits in the wrong order")
{
    OrbitDef def = cube();
    def.around = {};
    CHECK_THROWS_AS(OrbitCamera(def), Error);
    def.around = {{1, 1, 1}, {1, 1, 1}};
    CHECK_THROWS_AS(OrbitCamera(def), Error);
    def = cube();
    def.farthest = 0.05;
    CHECK_THROWS_WITH(OrbitCamera(def), "orbit camera: farthest must be > closest 0.1, got 0.05");
    def = cube();
    def.start.position.x = NAN;
    CHECK_THROWS_WITH(OrbitCamera(def), Catch::Contains("start.position"));
}

} // namespace orbit_camera_test
