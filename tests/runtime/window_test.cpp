#include "filasofia/filasofia.h"

#include "filasofia/window/null_window.h"

namespace window_test {

using namespace filasofia;
using window::NullWindow;

namespace {

struct PolypRemoved final : event::Event {
    static constexpr EventType kType = EventType::Custom1;
    PolypRemoved() : Event(kType) {}
    double volume = 0.0; ///< [m^3]
};

/// A live run in a window that nobody sees; `person` acts on it as soon as it is open.
RunReport runInWindow(Simulation& sim, std::function<void(NullWindow&)> person)
{
    sim.useWindow([person = std::move(person)](const window::WindowDef& def) {
        auto window = std::make_unique<NullWindow>(def);
        person(*window);
        return window;
    });
    return sim.run({.backend = visual::Backend::Null});
}

std::unique_ptr<event::Event> windowEvent(WindowEvent::Kind kind, int width = 0, int height = 0)
{
    auto event = std::make_unique<WindowEvent>();
    event->kind = kind;
    event->width = width;
    event->height = height;
    return event;
}

} // namespace

TEST_CASE("closing the window ends the run")
{
    Simulation sim;
    const RunReport report =
        runInWindow(sim, [](NullWindow& window) { window.inject(windowEvent(WindowEvent::Kind::CloseRequested)); });
    CHECK(report.finished == "window closed");
}

TEST_CASE("keys reach their observers with the simulation's time and step")
{
    Simulation sim;
    sim.run({.headless = true, .steps = 5}); // so that time is not 0
    double time = 0.0;
    std::uint64_t step = 0;
    sim.on<KeyEvent>([&](const KeyEvent& key) {
        time = key.time;
        step = key.step;
        sim.finish("a key");
    });
    const RunReport report = runInWindow(sim, [](NullWindow& window) { window.inject(std::make_unique<KeyEvent>()); });
    CHECK(report.finished == "a key");
    CHECK(time >= 0.005);
    CHECK(step >= 5);
}

TEST_CASE("a window of any size is drawn into, also one larger than pictures can be")
{
    Simulation sim;
    sim.on<WindowEvent>([&](const WindowEvent& event) {
        if (event.kind == WindowEvent::Kind::FocusLost) sim.finish("seen");
    });
    const RunReport report = runInWindow(sim, [](NullWindow& window) {
        window.inject(windowEvent(WindowEvent::Kind::Resized, 9000, 50));
        window.inject(windowEvent(WindowEvent::Kind::FocusLost, 9000, 50));
    });
    CHECK(report.finished == "seen");
}

TEST_CASE("a posted event carries the simulation's time and step, and any payload")
{
    Simulation sim;
    std::vector<double> seen;
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        if (update.step != 3) return;
        PolypRemoved removed;
        removed.volume = 1e-6;
        sim.post(removed);
    });
    sim.on<PolypRemoved>([&](const PolypRemoved& removed) {
        seen = {removed.time, static_cast<double>(removed.step), removed.volume};
    });
    sim.run({.headless = true, .steps = 5});
    REQUIRE(seen.size() == 3);
    CHECK(seen[0] == Approx(0.003));
    CHECK(seen[1] == 3);
    CHECK(seen[2] == 1e-6);
}

} // namespace window_test
