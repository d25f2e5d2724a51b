#include "filasofia/filasofia.h"

#include "filasofia/core/log.h"

#include "device/standin.h"

#include <dlfcn.h>

namespace haptic_vendor_test {

using namespace filasofia;
using device::DeviceNotice;

namespace {

/// The stand-in library at a path: the same instance that the driver opens.
template <class Do> void with(const char* path, Do&& what)
{
    void* handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    REQUIRE(handle);
    const auto function = reinterpret_cast<StandinFunction>(dlsym(handle, "standin"));
    REQUIRE(function);
    function([](Standin& all, void* call) { (*static_cast<std::remove_reference_t<Do>*>(call))(all); }, &what);
}

} // namespace

TEST_CASE("a run opens a vendor's device by its name, and survives unplugging it")
{
    std::vector<std::string> lines;
    setLogSink([&](LogLevel, std::string_view line) {
        if (line.find("haptic interface") != std::string_view::npos) lines.emplace_back(line);
    });
    with(STANDIN_DHD, [](Standin& all) { all = {}; });
    Simulation sim;
    const BodyId tool = sim.add(RigidBodyDef{.name = "tool",
                                             .elements = {{{0, 0, 0.1}, {}}},
                                             .mesh = shapes::sphere(5_mm),
                                             .dynamic = true,
                                             .mass = TotalMass{0.02},
                                             .gravity = false});
    sim.add(HapticInterfaceDef{.name = "right hand", .body = tool});
    std::vector<DeviceNotice::Kind> kinds;
    sim.on<DeviceEvent>([&](const DeviceEvent& event) { kinds.push_back(event.notice.kind); });
    double pushed = 0.0;
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        with(STANDIN_DHD, [&](Standin& all) {
            if (update.step == 100) all.position[0][1] = 0.01; // the vendor's y: to the right
            if (update.step == 100) all.velocity[0][1] = 0.0;
            if (update.step < 500) pushed = std::min(pushed, all.force[0][1]);
            if (update.step == 500) all.connected[0] = false;
        });
    });
    const RunReport report = sim.run({.headless = true, .steps = 800, .device = text("forcedimension:", STANDIN_DHD)});
    setLogSink({});
    CHECK(report.undone == 0);
    CHECK(distance(sim.physics().latest()->rigidBody(tool)->poses[0].position, {10_mm, 0, 0.1}) < 0.5_mm);
    CHECK(pushed < -0.1); // on its way the tool held the hand back
    CHECK(kinds == std::vector{DeviceNotice::Kind::Connected, DeviceNotice::Kind::Lost});
    CHECK(lines == std::vector<std::string>{"haptic interface 'right hand': device forcedimension: lost: communication "
                                            "error; it gets no force until it works again"});
    with(STANDIN_DHD, [](Standin& all) { CHECK_FALSE(all.open[0]); });
}

} // namespace haptic_vendor_test
