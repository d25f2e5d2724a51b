#include "filasofia/scene/motion.h"

#include "adding_fails.h"
#include "filasofia/filasofia.h"
#include "filasofia/scene/scene_file.h"
#include "scene_folder.h"

#include <catch2/catch.hpp>

#include <numbers>

namespace filasofia::scene {

using Catch::Contains;

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

TEST_CASE("motions: a hand that follows keys moves a body, and never pushes with more than its limit")
{
    const auto run = [](bool hand) {
        const SceneFolder folder;
        const SceneDef scene = folder.load(text(
            R"({"physics": {"gravity": [0, 0, 0], "threads": 1}, "bodies": [
{"name": "organ", "mesh": {"type": "block", "size": "2 2 2 cm", "cells": [4, 4, 4]}, "collision": [{}],
 "material": {"youngModulus": "50 kPa"}, "attachments": [{"box": ["-1 -1 -1 m", [1, -0.0099, 1]]}]},
{"type": "RigidBodyDef", "name": "tool", "elements": ["0 2 0 cm"], "mesh": {"type": "sphere", "radius": "6 mm"}, "collision": [{}],)",
            hand ? R"("dynamic": true, "mass": {"type": "TotalMass", "value": "20 g"},)" : "",
            R"( "motions": [{"keys": [{"time": 0, "pose": "0 2 0 cm"}, {"time": "0.2 s", "pose": "0 1.7 0 cm"},
 {"time": "0.4 s", "pose": "0 0.4 0 cm"}, {"time": "0.6 s", "pose": "0 0.4 0 cm"}, {"time": "0.8 s", "pose": "0 2.5 0 cm"}])",
            hand ? R"(, "hand": {"linearStiffness": "2 N/mm", "linearDamping": "5 N s/m", "forceLimit": "3 N"})" : "",
            "}]}]}"));
        Simulation sim(simulationDef(scene));
        const BodyId tool = addScene(sim, scene).bodies.at(1);
        struct {
            double free = 0.0, force = 0.0, end = 0.0; // [m] off its key in the air, [N] largest, [m] off at the end
        } out;
        sim.on<event::PhysicsUpdateEvent>([&](const event::PhysicsUpdateEvent& now) {
            const frame::FrameRef frame = sim.physics().latest();
            const double y = frame->rigidBody(tool)->poses[0].position.y;
            if (now.time < 0.2) out.free = std::max(out.free, std::abs(y - (0.02 - 0.015 * now.time)));
            out.force = std::max(out.force, length(frame::forceOn(tool, frame->contacts)));
            out.end = std::abs(y - 0.025);
        });
        sim.run({.headless = true, .steps = 1000});
        return out;
    };
    const auto told = run(false), held = run(true);
    CHECK(told.force > 10.0);
    CHECK(held.force < 3.3); // and what decelerating 20 g takes
    CHECK(held.force > 2.7);
    CHECK(held.free < 0.2e-3);
    CHECK(held.end < 0.05e-3);
}

TEST_CASE("motions: a hand needs a dynamic body, and a dynamic body a hand")
{
    const auto refused = [](const char* body, const char* hand) {
        return addingFails(
            SceneFolder(),
            text(
                R"({"bodies": [{"type": "RigidBodyDef", "name": "tool", "mesh": {"type": "sphere", "radius": "6 mm"},)",
                body, R"("motions": [{"keys": [{"time": 1, "pose": "0 2 0 cm"}])", hand, "}]}]}"));
    };
    CHECK_THAT(refused("", R"(, "hand": {})"),
               Contains("rigid body 'tool': motions[0].hand needs a dynamic body; this one is kinematic"));
    CHECK_THAT(refused(R"("dynamic": true,)", ""),
               Contains("motions[0] moves a dynamic body, which only forces move; give it a hand"));
    CHECK_THAT(refused(R"("dynamic": true,)", R"(, "hand": {"forceLimit": 0})"), Contains("forceLimit must be > 0"));
}

} // namespace filasofia::scene
