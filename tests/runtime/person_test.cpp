#include "filasofia/filasofia.h"

#include "window/attended.h"

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>

namespace person_test {

using namespace filasofia;
namespace fs = std::filesystem;

namespace {

std::string contents(const std::string& name)
{
    std::ifstream file(name, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

} // namespace

TEST_CASE("a person at a real window turns the camera, takes a picture by key and leaves with Escape")
{
    const window::VirtualDisplay display;
    const fs::path before = fs::current_path(),
                   folder = fs::temp_directory_path() / text("filasofia_person_", getpid());
    fs::create_directories(folder);
    fs::current_path(folder);

    Simulation sim({.physics = {.gravity = {}},
                    .window = {.width = 160, .height = 120},
                    .look = {.direction = {0, 0, 1}, .quality = visual::Quality::Low}});
    sim.show(sim.add(RigidBodyDef{.mesh = shapes::box({0.01, 0.02, 0.05})}));
    std::atomic<bool> released = false;
    sim.on<MouseButtonEvent>([&](const MouseButtonEvent& event) { released = released || !event.pressed; });
    int looks = 0, did = 0;
    // Each action waits for the effect of the one before it, not for time.
    const auto act = [&](window::Person& person) {
        ++looks;
        if (did == 0 && looks == 3) {
            sim.screenshot("before.png");
            ++did;
        } else if (did == 1 && fs::exists("before.png")) {
            person.moveMouse(60, 60);
            person.button(1, true);
            person.moveMouse(95, 70);
            person.button(1, false);
            ++did;
        } else if (did == 2 && released) {
            person.key("p", true);
            person.key("p", false);
            ++did;
        } else if (did == 3 && fs::exists("filasofia_001.png")) {
            person.key("Escape", true);
            ++did;
        }
    };
    sim.useWindow([&](const window::WindowDef& def) { return std::make_unique<window::Attended>(def, act); });
    const RunReport report = sim.run({.seconds = 100});
    CHECK(report.finished == "Escape");
    CHECK(contents("before.png").size() > 100);
    CHECK(contents("filasofia_001.png").size() > 100);
    CHECK(contents("filasofia_001.png") != contents("before.png"));
    fs::current_path(before);
    fs::remove_all(folder);
}

} // namespace person_test
