#include "filasofia/filasofia.h"

#include "filasofia/runtime/inspector.h"
#include "filasofia/visual/debug_shapes.h"
#include "filasofia/window/null_window.h"
#include "visual/gui_person.h"

#include <filesystem>

namespace inspector_test {

using namespace filasofia;
using namespace filasofia::runtime;
using visual::GuiPerson;
using window::NullWindow;

namespace {

/// A box of 8 g and a soft cube on a table, stepped by the test, with an open inspector.
struct InspectedScene {
    explicit InspectedScene(Backend backend = Backend::Null, int width = 800, int height = 600)
        : visual({.backend = backend, .width = width, .height = height}), inspector(impl, visual)
    {
        table = impl.physics.add(RigidBodyDef{.name = "table",
                                              .elements = {{{0, -5_mm, 0}, {}}},
                                              .mesh = shapes::box({120_mm, 10_mm, 60_mm}),
                                              .collision = {{}}});
        box = impl.physics.add(RigidBodyDef{.name = "box",
                                            .elements = {{{30_mm, 10.2_mm, 0}, {}}},
                                            .mesh = shapes::box({20_mm, 20_mm, 20_mm}),
                                            .dynamic = true,
                                            .collision = {{}}});
        SoftBodyDef soft{.name = "cube", .mesh = shapes::block({20_mm, 20_mm, 20_mm}), .collision = {{}}};
        soft.pose.position = {0, 10.2_mm, 0};
        cube = impl.physics.add(soft);
        impl.bindings.show(cube, {.subdivision = 1}, impl.physics);
        impl.bindings.show(box, {.material = MetalMaterial{}}, impl.physics);
        impl.bindings.show(table, {.material = MetalMaterial{.baseColor = {0.1, 0.2, 0.25}, .roughness = 0.7}},
                           impl.physics);
        impl.bindings.addPending(visual);
        impl.dressScene(visual);
        inspector.setOpen(true);
    }
    ~InspectedScene() { impl.bindings.release(); }

    void step(int count)
    {
        const physics::StepBudget budget{.now = [this] { return now += 20'000; }};
        for (int i = 0; i < count; ++i) {
            now += 800'000;
            impl.beforeStep(1e-3);
            last = impl.physics.step(1e-3, 0, budget);
            impl.afterStep(last);
        }
    }
    void picture()
    {
        impl.mapNewestFrame(visual);
        inspector.beforePicture();
        visual.render();
        inspector.afterPicture(true);
    }
    void run(int pictures)
    {
        for (int i = 0; i < pictures; ++i) {
            step(16);
            picture();
        }
    }

    std::int64_t now = 0;
    Simulation::Impl impl{[] {
        SimulationDef def;
        def.physics.threads = 1;
        return def;
    }()};
    visual::VisualServer visual;
    Inspector inspector;
    GuiPerson person{visual};
    BodyId table, box, cube;
    physics::StepReport last;

private:
    /// The inspector uses the same simulated clock.
    const bool clocked = [this] {
        impl.clock.now = [this] { return now; };
        return true;
    }();
};

std::unique_ptr<event::Event> keyEvent(event::KeyCode code, bool pressed = true)
{
    auto event = std::make_unique<KeyEvent>();
    event->key = code;
    event->pressed = pressed;
    return event;
}

constexpr double kWeight = 0.008 * 9.81; ///< [N]

} // namespace

TEST_CASE("the inspector shows its rates, and every panel is drawn")
{
    InspectedScene scene(hasBackend(Backend::Headless) ? Backend::Headless : Backend::Null);
    scene.inspector.show = {.wireframe = true, .contacts = true, .forces = true};
    scene.run(30);
    scene.step(16);
    scene.impl.mapNewestFrame(scene.visual);
    scene.inspector.beforePicture();
    const visual::Image image = scene.visual.capture();
    if (hasBackend(Backend::Headless))
        visual::savePng(image,
                        std::filesystem::path(FILASOFIA_BINARY_DIR) / "inspector.png"); // to look at
    CHECK(scene.inspector.problem().empty());
}

TEST_CASE("an arrow in newtons is as long as its force, and points where it pushes")
{
    InspectedScene scene;
    scene.impl.physics.remove(scene.cube);
    scene.inspector.show = {.forces = true, .metresPerNewton = 0.5};
    scene.step(400); // the box rests
    scene.impl.mapNewestFrame(scene.visual);
    scene.inspector.beforePicture();
    const visual::DebugPicture drawn = scene.visual.debug().impl().shapes.picture();
    float low = 1, high = -1;
    for (const visual::DebugVertex& vertex : drawn.onTop.vertices) {
        if (vertex.color[2] != 255) continue; // an arrow of one contact
        low = std::min(low, vertex.position.y);
        high = std::max(high, vertex.position.y);
    }
    CHECK(low == Approx(0.0).margin(1e-4));                   // from the contact
    CHECK(high - low == Approx(0.5 * kWeight).epsilon(0.01)); // upwards, on the box: the table is kinematic
    scene.inspector.show.metresPerNewton = 0.0;               // the largest is then a quarter of the scene, rounded
    scene.visual.debug().clear();
    scene.inspector.beforePicture();
    CHECK(scene.visual.debug().counts().texts == 1);
    const auto texts = scene.visual.debug().impl().shapes.texts();
    REQUIRE(texts.size() == 1);
    CHECK(std::stod(texts[0].text) == Approx(kWeight).epsilon(0.01));
}

TEST_CASE("wireframe and collision models are lines of the right number where the bodies are")
{
    InspectedScene scene;
    scene.step(2);
    scene.impl.mapNewestFrame(scene.visual);
    const auto lines = [&](InspectorShow show) {
        scene.inspector.show = show;
        scene.visual.debug().clear();
        scene.inspector.beforePicture();
        return scene.visual.debug().counts().vertices / 4;
    };
    CHECK(lines({}) == 0);
    const long cube = 3 * 192 / 2, box = 3 * 12 / 2; // edges of closed surfaces with this many triangles
    CHECK(lines({.collision = true}) == cube + 2 * box);
    CHECK(lines({.wireframe = true}) == cube + 2 * 6 * 5); // each side of a box is drawn separately

    scene.impl.physics.remove(scene.table);
    scene.step(1);
    CHECK(lines({.collision = true}) == cube + box);
}

TEST_CASE("pause, single steps and reset act on the next steps")
{
    InspectedScene scene;
    scene.step(5);
    CHECK(scene.last.step == 5);
    scene.impl.physics.pause(true);
    scene.step(3);
    CHECK(scene.last.step == 5);
    CHECK(scene.last.dt == 0.0);
    scene.impl.pause.askSingleStep();
    scene.step(3);
    CHECK(scene.last.step == 6);
    CHECK(scene.last.dt == 0.0);
    scene.impl.pause.askSingleStep();
    scene.step(3);
    CHECK(scene.last.step == 7);
    CHECK(scene.last.dt == 0.0);
    scene.impl.physics.pause(false);
    scene.step(300);
    CHECK(scene.impl.physics.latest()->rigidBody(scene.box)->poses[0].position.y < 10.1_mm);
    scene.impl.physics.reset();
    scene.impl.physics.pause(true);
    scene.step(1);
    CHECK(scene.impl.physics.latest()->rigidBody(scene.box)->poses[0].position.y == Approx(10.2_mm));
}

TEST_CASE("a script goes on in a single step")
{
    InspectedScene scene;
    std::vector<double> called;
    scene.impl.everyStep.add([&](double time) { called.push_back(time); });
    scene.impl.physics.pause(true);
    scene.step(3);
    called.clear();
    scene.impl.pause.askSingleStep();
    scene.step(3);
    CHECK(called.size() == 1);
}

TEST_CASE("a screenshot is of the scene, without the inspector, under a name of its own")
{
    const std::filesystem::path folder = std::filesystem::path(FILASOFIA_BINARY_DIR) / "screenshots";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    InspectedScene scene;
    scene.inspector.screenshotFolder = folder.string();
    scene.run(2);
    for (int i = 0; i < 2; ++i) {
        scene.inspector.askForScreenshot();
        scene.run(1);
    }
    CHECK(std::filesystem::exists(folder / "filasofia_0001.png"));
    CHECK(std::filesystem::exists(folder / "filasofia_0002.png"));
    scene.inspector.screenshotFolder = "/no/such/folder";
    scene.inspector.askForScreenshot();
    scene.run(1);
    CHECK(scene.inspector.problem().find("/no/such/folder") != std::string::npos);
    CHECK(scene.inspector.open());
}

TEST_CASE("a thousand blind clicks and drags in the inspector break nothing")
{
    InspectedScene scene;
    scene.inspector.screenshotFolder = "/no/such/folder";
    scene.run(3);
    std::mt19937 random(7);
    const auto upTo = [&](int bound) { return int(random() % unsigned(bound)); };
    for (int i = 0; i < 1000; ++i) {
        scene.person.move(10 + upTo(320), 10 + upTo(590));
        scene.person.press();
        if (upTo(4) == 0) scene.person.move(10 + upTo(320), 10 + upTo(590));
        scene.person.release();
        if (upTo(10) == 0) scene.person.wheel(upTo(2) ? 3.0 : -3.0);
        if (upTo(10) == 0) scene.person.type("1e9");
        if (upTo(10) == 0) scene.person.stroke(KeyCode::Enter);
        scene.inspector.setOpen(true); // a click may have closed it
        scene.step(2);
        scene.picture();
        scene.picture();
    }
    scene.person.look(20);
    scene.impl.physics.pause(false);
    const std::uint64_t before = scene.last.step;
    scene.step(5);
    CHECK(scene.last.step >= before);
    CHECK(std::isfinite(scene.last.time));
}

TEST_CASE("F1 opens and closes the inspector in a live run, and keys for a Gui reach no observer")
{
    Simulation sim({.window = {.width = 320, .height = 240}});
    sim.show(sim.add(RigidBodyDef{.mesh = shapes::box({20_mm, 20_mm, 20_mm})}));
    int f1 = 0, pictures = 0;
    NullWindow* opened = nullptr;
    sim.on<KeyEvent>([&](const KeyEvent& key) { f1 += key.key == KeyCode::F1; });
    sim.useWindow([&](const window::WindowDef& def) {
        auto window = std::make_unique<NullWindow>(def);
        opened = window.get();
        window->inject(keyEvent(KeyCode::F1));
        window->inject(keyEvent(KeyCode::F1, false));
        return window;
    });
    sim.on<VisualUpdateEvent>([&](const VisualUpdateEvent&) { ++pictures; });
    // After the inspector has had its pictures, the person closes it and leaves.
    sim.show(GuiDef{.renderCallback = [&, drawn = 0]() mutable {
        if (++drawn != 8) return;
        opened->inject(keyEvent(KeyCode::F1));
        opened->inject(keyEvent(KeyCode::Escape));
    }});
    CHECK_THROWS_WITH(sim.show(GuiDef{.name = "huge", .scale = 100}), "gui 'huge': scale must be in [0.5, 8], got 100");
    const RunReport report = sim.run({.backend = Backend::Null, .seconds = 60});
    CHECK(report.finished == "Escape"); // from a key of the run
    CHECK(f1 == 0);
}

TEST_CASE("a window that is closed while a Gui is in use ends the run")
{
    Simulation sim({.window = {.width = 320, .height = 240}});
    NullWindow* opened = nullptr;
    sim.useWindow([&](const window::WindowDef& def) {
        auto window = std::make_unique<NullWindow>(def);
        opened = window.get();
        window->inject(keyEvent(KeyCode::F1));
        auto press = std::make_unique<MouseButtonEvent>();
        press->pressed = true;
        press->x = press->y = 40;
        window->inject(std::move(press));
        return window;
    });
    sim.show(GuiDef{.renderCallback = [&, drawn = 0]() mutable {
        if (++drawn != 5) return;
        auto closing = std::make_unique<WindowEvent>();
        closing->kind = WindowEvent::Kind::CloseRequested;
        opened->inject(std::move(closing));
    }});
    CHECK(sim.run({.backend = Backend::Null, .seconds = 60}).finished == "window closed");
}

} // namespace inspector_test
