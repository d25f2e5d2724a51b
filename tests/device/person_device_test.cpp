#include "filasofia/device/devices.h"

namespace person_device_test {

using namespace filasofia;
using namespace filasofia::device;

TEST_CASE("a mouse moves the hand by its pixels, smoothly, and keys by their time")
{
    PersonDevice mouse("mouse", {.reach = 1e-3, .speed = 0.1});
    mouse.open();
    mouse.read(0.0);
    mouse.feed({.moved = {10, 0, 0}});
    mouse.feed({.moved = {10, -5, 0}, .buttons = 2u});
    Vec3 last;
    double time = 0.0;
    for (int i = 0; i < 500; ++i) {
        const DeviceSample sample = mouse.read(time += 1e-3);
        CHECK(distance(sample.hand.pose.position, last) < 1e-3); // no jump
        CHECK(distance(sample.hand.velocity, (sample.hand.pose.position - last) / 1e-3) < 0.1);
        CHECK(sample.buttons == 2u);
        last = sample.hand.pose.position;
    }
    CHECK(distance(last, {0.02, -0.005, 0}) < 1e-6);

    mouse.feed({.push = Vec3{0, 0, -1}});
    for (int i = 0; i < 1000; ++i) mouse.read(time += 1e-3);
    CHECK(mouse.read(time).hand.velocity.z == Approx(-0.1).epsilon(1e-3));
    mouse.feed({.push = Vec3{}});
    for (int i = 0; i < 1000; ++i) last = mouse.read(time += 1e-3).hand.pose.position;
    CHECK(last.z == Approx(-0.1).epsilon(1e-3));
    CHECK_FALSE(mouse.capabilities().force);
    CHECK_FALSE(mouse.capabilities().orientation);
}

TEST_CASE("a cap that is turned turns the hand, and one that is held for hours does not leave the desk")
{
    PersonDevice cap("spacemouse", {.speed = 0.1, .turnSpeed = 1.0});
    cap.feed({.push = Vec3{1, 0, 0}, .twist = Vec3{0, 0, 1}});
    DeviceSample sample;
    for (int i = 0; i <= 1000; ++i) sample = cap.read(i * 1e-3);
    CHECK(length(rotationVector(sample.hand.pose.orientation)) == Approx(1.0).epsilon(0.03));
    CHECK(sample.hand.angularVelocity.z == Approx(1.0).epsilon(1e-6));
    for (int i = 0; i < 1000; ++i) sample = cap.read(1.0 + i * 0.1);
    CHECK(sample.hand.pose.position.x == Approx(0.5));
    sample = cap.read(1e9); // a longer time counts as a pause
    CHECK(isFinite(sample.hand.pose));
}

TEST_CASE("a mouse turns the hand about the device's axes and then about its own, smoothly")
{
    PersonDevice mouse("mouse", {.reach = 1e-3, .turn = 0.01});
    CHECK(mouse.capabilities().orientation);
    mouse.open();
    double time = 0.0;
    const auto turn = [&](Vec3 pixels) {
        mouse.feed({.turned = pixels});
        Quat before = mouse.read(time).hand.pose.orientation;
        for (int i = 0; i < 400; ++i) {
            time += 1e-3;
            const DeviceSample now = mouse.read(time);
            const Vec3 turned = rotationVector(now.hand.pose.orientation * conjugate(before));
            CHECK(distance(turned, 1e-3 * now.hand.angularVelocity) < 1.5e-3);
            CHECK(length(turned) < 0.03); // no jerk
            before = now.hand.pose.orientation;
        }
        return before;
    };
    const Quat aside = axisAngle({0, 1, 0}, -0.5);
    CHECK(length(rotationVector(turn({0, -50, 0}) * conjugate(aside))) < 1e-6);
    CHECK(length(rotationVector(turn({0, 0, 100}) * conjugate(aside * axisAngle({0, 0, 1}, 1.0)))) < 1e-6);
}

} // namespace person_device_test
