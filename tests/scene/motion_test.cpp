#include "filasofia/scene/motion.h"

#include <catch2/catch.hpp>

#include <numbers>

namespace filasofia::scene {

TEST_CASE("motions: an element goes straight from key to key and turns the shortest way")
{
    const Quat quarter = axisAngle({0, 0, 1}, std::numbers::pi / 2);
    ElementMotion motion{.keys = {{1.0, {{0, 0, 0}}}, {3.0, {{0, 0.02, 0}, quarter}}}};
    CHECK(poseAt(motion, 0.0).position == Vec3{});
    CHECK(poseAt(motion, 1.0).position == Vec3{});
    const Pose half = poseAt(motion, 2.0);
    CHECK(half.position.y == Approx(0.01));
    const Quat eighth = axisAngle({0, 0, 1}, std::numbers::pi / 4);
    CHECK(std::abs(dot(half.orientation, eighth)) == Approx(1.0).epsilon(1e-12));
    CHECK(poseAt(motion, 3.0) == motion.keys[1].pose);
    CHECK(poseAt(motion, 99.0) == motion.keys[1].pose);

    // The same rotation with the other sign is as near as the first.
    motion.keys[1].pose.orientation = {-quarter.w, -quarter.x, -quarter.y, -quarter.z};
    CHECK(std::abs(dot(poseAt(motion, 2.0).orientation, eighth)) == Approx(1.0).epsilon(1e-12));

    motion.repeat = true;
    CHECK(poseAt(motion, 5.0).position.y == Approx(0.01)); // 2 s into the second round
    CHECK(poseAt(motion, 3.5).position == Vec3{});
}

} // namespace filasofia::scene
