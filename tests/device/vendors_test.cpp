#include "filasofia/device/devices.h"
#include "filasofia/device/haptic_servo.h"

#include "device/standin.h"

#include <dlfcn.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace vendors_test {

using namespace filasofia;
using namespace filasofia::device;

namespace {

/// The stand-in library at a path: the same instance that the driver has opened.
class Vendor {
public:
    explicit Vendor(const char* path)
    {
        void* handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
        REQUIRE(handle);
        function_ = reinterpret_cast<StandinFunction>(dlsym(handle, "standin"));
        REQUIRE(function_);
        with([](Standin& all) { all = {}; });
    }
    template <class Do> void with(Do&& what) const
    {
        function_([](Standin& all, void* call) { (*static_cast<std::remove_reference_t<Do>*>(call))(all); }, &what);
    }

private:
    StandinFunction function_;
};

/// Waits for something on another thread: as long as it takes, up to the test program's own limit.
template <class Is> void waitFor(Is&& is)
{
    while (!is()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

DeviceSample readUntil(HapticDevice& device, DeviceStatus status, double& time)
{
    DeviceSample sample;
    waitFor([&] {
        sample = device.read(time += 1e-3);
        return sample.status == status;
    });
    return sample;
}

} // namespace

TEST_CASE("libdhd: place, velocity and force turn into our axes and back, and each device is its own")
{
    const Vendor vendor(STANDIN_DHD);
    vendor.with([](Standin& all) {
        all.position[0][0] = 0.01, all.position[0][1] = 0.02, all.position[0][2] = 0.03; // towards the user, right, up
        all.velocity[0][2] = 0.5;
        all.buttons[1] = 5;
    });
    const auto first = makeDevice(ForceDimensionDevice{0}, STANDIN_DHD),
               second = makeDevice(ForceDimensionDevice{1}, STANDIN_DHD);
    first->open();
    second->open();
    vendor.with([](Standin& all) { CHECK((all.open[0] && all.open[1] && all.forceEnabled[0])); });
    const DeviceSample sample = first->read(0.0);
    CHECK(sample.status == DeviceStatus::Ready);
    CHECK(sample.hand.pose.position == Vec3{0.02, 0.03, 0.01});
    CHECK(sample.hand.velocity == Vec3{0, 0.5, 0});
    // A quarter turn about the axis that points up, which is our y.
    CHECK(distance(rotationVector(sample.hand.pose.orientation), {0, std::acos(0.0), 0}) < 1e-12);
    CHECK(sample.buttons == 0);
    CHECK(second->read(0.0).buttons == 5);
    CHECK(first->capabilities().torque);
    CHECK_FALSE(second->capabilities().torque);

    CHECK(first->write({{1, 2, 3}, {4, 5, 6}}));
    vendor.with([](Standin& all) {
        CHECK((all.force[0][0] == 3 && all.force[0][1] == 1 && all.force[0][2] == 2));
        CHECK((all.torque[0][0] == 6 && all.torque[0][1] == 4 && all.torque[0][2] == 5));
        CHECK(all.force[1][0] == 0);
    });
    first->close();
    vendor.with([](Standin& all) {
        CHECK((all.force[0][0] == 0 && !all.open[0] && !all.forceEnabled[0])); // no force is left
        CHECK(all.open[1]);
    });
}

TEST_CASE("libdhd: no device, one that is gone, not calibrated or failing")
{
    const Vendor vendor(STANDIN_DHD);
    const auto third = makeDevice(ForceDimensionDevice{2}, STANDIN_DHD);
    CHECK_THROWS_WITH(third->open(),
                      "device forcedimension: index must be < 2 (the number of connected devices), got 2");
    const auto device = makeDevice(ForceDimensionDevice{0}, STANDIN_DHD);
    vendor.with([](Standin& all) { all.connected[0] = false; });
    CHECK_THROWS_WITH(device->open(), "device forcedimension: cannot be opened: communication error");
    CHECK(device->write({{1, 0, 0}, {}})); // nothing comes from a device that is not open
    vendor.with([](Standin& all) { all.connected[0] = true, all.calibrated[0] = false; });
    device->open();
    CHECK(device->read(0).status == DeviceStatus::NotCalibrated);
    vendor.with([](Standin& all) { all.calibrated[0] = true; });
    CHECK(device->read(0).status == DeviceStatus::Ready);
    vendor.with([](Standin& all) { all.failing[0] = true; });
    CHECK(device->read(0).status == DeviceStatus::Failed);
    CHECK(device->problem() == "communication error"); // in one line
    CHECK_FALSE(device->write({{1, 0, 0}, {}}));
    vendor.with([](Standin& all) { all.failing[0] = false, all.connected[0] = false; });
    CHECK(device->read(0).status == DeviceStatus::Lost);
    device->close();
    vendor.with([](Standin& all) { all.connected[0] = true; });
    device->open();
    CHECK(device->read(0).status == DeviceStatus::Ready);
}

TEST_CASE("libHD: place, velocity, buttons and force come through its own servo loop, two devices share it")
{
    const Vendor vendor(STANDIN_HD);
    vendor.with([](Standin& all) {
        all.position[0][1] = 0.02;
        all.velocity[0][0] = 0.25;
        all.buttons[0] = 2;
        all.position[1][2] = -0.05;
    });
    const auto first = makeDevice(OpenHapticsDevice{}, STANDIN_HD),
               second = makeDevice(OpenHapticsDevice{"Left Device"}, STANDIN_HD);
    double time = 0.0;
    first->open();
    static_cast<void>(readUntil(*first, DeviceStatus::Ready, time));
    second->open(); // while the first one's loop runs
    DeviceSample sample = readUntil(*first, DeviceStatus::Ready, time);
    CHECK(distance(sample.hand.pose.position, {0, 0.02, 0}) < 1e-15);
    CHECK(distance(sample.hand.velocity, {0.25, 0, 0}) < 1e-15);
    CHECK(sample.hand.angularVelocity == Vec3{0, 0, 0.5});
    CHECK(distance(rotationVector(sample.hand.pose.orientation), {0, std::acos(0.0), 0}) < 1e-12);
    CHECK(sample.buttons == 2);
    CHECK(readUntil(*second, DeviceStatus::Ready, time).hand.pose.position.z == Approx(-0.05));
    CHECK(first->capabilities().forceLimit == 7.9);
    CHECK_FALSE(first->capabilities().torque);

    bool arrived = false;
    waitFor([&] {
        first->write({{1, 2, 3}, {}});
        vendor.with(
            [&](Standin& all) { arrived = all.force[0][0] == 1 && all.force[0][1] == 2 && all.force[0][2] == 3; });
        return arrived;
    });
    // If the servo stops sending forces, the hand is left without a force.
    waitFor([&] {
        vendor.with([&](Standin& all) { arrived = all.force[0][0] == 0; });
        return arrived;
    });
    first->close();
    vendor.with([](Standin& all) { CHECK((!all.open[0] && all.open[1])); });
    vendor.with([](Standin& all) { all.position[1][2] = 0.07; });
    waitFor([&] { return second->read(time += 1e-3).hand.pose.position.z > 0.06; }); // the second device continues
}

TEST_CASE("libHD: no device, one that is gone, not calibrated, failing or stopped")
{
    const Vendor vendor(STANDIN_HD);
    CHECK_THROWS_WITH(makeDevice(OpenHapticsDevice{"Right Device"}, STANDIN_HD)->open(),
                      "device openhaptics: 'Right Device' cannot be opened: Communication error");
    double time = 0.0;
    {
        vendor.with([](Standin& all) { all.calibrated[0] = false; });
        const auto device = makeDevice(OpenHapticsDevice{}, STANDIN_HD);
        device->open();
        waitFor([&] { return device->read(time += 1e-3).status == DeviceStatus::NotCalibrated; });
        vendor.with([](Standin& all) { all.calibrated[0] = true; });
        static_cast<void>(readUntil(*device, DeviceStatus::Ready, time)); // the driver checks again now and then
        vendor.with([](Standin& all) { all.failing[0] = true; });
        static_cast<void>(readUntil(*device, DeviceStatus::Failed, time));
        CHECK(device->problem() == "Motors are warm");
        vendor.with([](Standin& all) { all.failing[0] = false; });
        static_cast<void>(readUntil(*device, DeviceStatus::Ready, time));
        vendor.with([](Standin& all) { all.connected[0] = false; });
        static_cast<void>(readUntil(*device, DeviceStatus::Lost, time));
        CHECK(device->problem() == "Communication error");
    }
    vendor.with([](Standin& all) { all.connected[0] = true; });
    const auto device = makeDevice(OpenHapticsDevice{}, STANDIN_HD);
    device->open();
    static_cast<void>(readUntil(*device, DeviceStatus::Ready, time));
    vendor.with([](Standin& all) { all.blockMilliseconds = 100; });
    DeviceSample sample;
    const double before = time;
    waitFor([&] { // its frames stop while our time goes on
        sample = device->read(time = before + 1.0);
        return sample.status == DeviceStatus::Failed || (time += 1.0, false);
    });
    CHECK(device->problem() == "its servo loop has stopped");
    static_cast<void>(readUntil(*device, DeviceStatus::Ready, time));
}

TEST_CASE("a servo on its thread survives a vendor's device that blocks, reports nonsense, disappears and comes back")
{
    for (const char* path : {STANDIN_DHD, STANDIN_HD}) {
        const Vendor vendor(path);
        const DeviceDef def =
            path == std::string(STANDIN_DHD) ? DeviceDef(ForceDimensionDevice{}) : DeviceDef(OpenHapticsDevice{});
        const auto device = makeDevice(def, path);
        std::mutex mutex;
        std::vector<DeviceNotice> notices;
        HapticServo servo(*device, {.rampIn = 0.0}, steadyServoClock(), [&](const DeviceNotice& notice) {
            const std::lock_guard lock(mutex);
            notices.push_back(notice);
        });
        const auto heard = [&](DeviceNotice::Kind kind, std::size_t count) {
            waitFor([&] {
                const std::lock_guard lock(mutex);
                std::size_t found = 0;
                for (const DeviceNotice& notice : notices) found += notice.kind == kind;
                return found >= count;
            });
        };
        const auto is = [&](ServoState state) {
            waitFor([&] {
                ServoSnapshot seen;
                return servo.latest(seen) && seen.tick.state == state;
            });
        };
        using Kind = DeviceNotice::Kind;
        servo.start(false);
        heard(Kind::Connected, 1);
        is(ServoState::Waiting); // no state of the body has arrived
        vendor.with([](Standin& all) { all.garbage[0] = true; });
        heard(Kind::Error, 1);
        is(ServoState::Implausible);
        vendor.with([](Standin& all) { all.garbage[0] = false; });
        is(ServoState::Waiting);
        vendor.with([](Standin& all) { all.blockMilliseconds = 100; });
        heard(Kind::Error, 2);
        vendor.with([](Standin& all) { all.buttons[0] = 1; });
        heard(Kind::Button, 1);
        vendor.with([](Standin& all) { all.connected[0] = false; });
        heard(Kind::Lost, 1);
        is(ServoState::Lost);
        std::size_t before = 0;
        {
            const std::lock_guard lock(mutex);
            for (const DeviceNotice& notice : notices) before += notice.kind == Kind::Connected;
        }
        vendor.with([](Standin& all) { all.connected[0] = true; });
        heard(Kind::Connected, before + 1); // the servo tries again every second
        is(ServoState::Waiting);
        servo.stop();
        vendor.with([](Standin& all) { CHECK_FALSE(all.open[0]); });
    }
}

} // namespace vendors_test
