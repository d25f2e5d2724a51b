#include "shown_stage.h"

#include "filasofia/filasofia.h"

namespace follow_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

double apart(const Pose& a, const Pose& b)
{
    return distance(a.position, b.position) + length(rotationVector(conjugate(a.orientation) * b.orientation));
}

/// A stage whose bindings know their visual server.
struct FollowStage : ShownStage {
    FollowStage() { map(); }
    void follow(visual::Transform& transform, BodyId id, const FollowDef& def = {})
    {
        bindings.follow(transform, id, def, physics);
    }
};

const FollowDef kOnSide{.at = FollowNearest{.place = {1, 0.01, 0.01}}};

} // namespace

TEST_CASE("a light on an element of a rigid body follows it with its offset, from the start on")
{
    FollowStage stage;
    const Pose start{{1, 2, 3}, axisAngle({0, 1, 0}, 0.3)}, offset{{0, 0, 0.1}, axisAngle({1, 0, 0}, 0.2)};
    const BodyId box = stage.addBox({Pose{}, start});
    visual::Light& light = stage.visual.add(visual::LightDef{});
    stage.follow(light, box, {.at = FollowElement{1}, .offset = offset});
    CHECK(apart(light.worldPose(), start * offset) < 1e-7); // before the first step
    const Pose next{{1, 2.01, 3}, axisAngle({0, 1, 0}, 0.31)};
    stage.physics.setPose(box, next, 1);
    stage.step();
    CHECK(apart(light.worldPose(), next * offset) < 1e-7);
}

TEST_CASE("a camera on a soft body moves with its surface")
{
    FollowStage stage;
    const Pose pose{{0.5, 0, 0}, axisAngle({0, 0, 1}, 0.4)};
    const BodyId block = stage.addBlock(pose);
    visual::Camera& camera = stage.visual.add(visual::CameraDef{});
    const Pose offset{{0, 0, 0.05}, {}};
    stage.follow(camera, block, {.at = kOnSide.at, .offset = offset});
    // On the side at x = 2 cm, looking outwards along its own +Z, 5 cm away.
    CHECK(distance(camera.worldPose().position, transform(pose, {0.07, 0.01, 0.01})) < 1e-12);
    CHECK(distance(rotate(camera.worldPose().orientation, {0, 0, 1}), rotate(pose.orientation, {1, 0, 0})) < 1e-12);

    stage.physics.setGravity({0, -5, 0});
    for (int i = 0; i < 10; ++i) stage.step();
    const auto frame = stage.physics.latest();
    const Vec3 fallen = frame->softBody(block)->positions.front() - transform(pose, ShownStage::mesh()->nodes.front());
    CHECK(fallen.y < -1e-4);
    CHECK(distance(camera.worldPose().position, transform(pose, {0.07, 0.01, 0.01}) + fallen) < 1e-6);
}

TEST_CASE("a follower leaves its parent, and stops following once it has one")
{
    FollowStage stage;
    const BodyId box = stage.addBox();
    visual::Transform& rig = stage.visual.addTransform("rig");
    rig.setPose({{9, 9, 9}, {}});
    visual::Light& light = stage.visual.add(visual::LightDef{});
    light.attachTo(rig);
    stage.follow(light, box);
    CHECK(light.parent() == nullptr);
    CHECK(light.worldPose().position == Vec3{});
    light.attachTo(rig);
    stage.physics.setPose(box, {{0, 0.01, 0}, {}});
    stage.step();
    CHECK(light.pose().position == Vec3{}); // relative to the rig, untouched
}

TEST_CASE("a follower stays where it is when it is let go and when its body is gone")
{
    FollowStage stage;
    const BodyId box = stage.addBox(), other = stage.addBox();
    visual::Light& let = stage.visual.add(visual::LightDef{});
    visual::Camera& left = stage.visual.add(visual::CameraDef{});
    stage.follow(let, box);
    stage.follow(left, other);
    for (const BodyId id : {box, other}) stage.physics.setPose(id, {{0.01, 0, 0}, {}});
    stage.step();
    stage.bindings.unfollow(let);
    stage.physics.setPose(box, {{0.02, 0, 0}, {}});
    stage.physics.remove(other);
    stage.step();
    stage.step();
    CHECK(let.worldPose().position == Vec3{0.01, 0, 0});
    CHECK(left.worldPose().position == Vec3{0.01, 0, 0});
}

TEST_CASE("following again replaces what was followed, and a transform that ends is forgotten")
{
    FollowStage stage;
    const BodyId box = stage.addBox(), other = stage.addBox({Pose{{5, 0, 0}, {}}});
    visual::Light& light = stage.visual.add(visual::LightDef{});
    stage.follow(light, box);
    stage.follow(light, other);
    stage.step();
    CHECK(light.worldPose().position == Vec3{5, 0, 0});
    stage.visual.remove(light);
    stage.step(); // nothing touches a destroyed transform
    CHECK(stage.visual.statistics().lights == 0);
}

TEST_CASE("a body that comes with the next step is waited for, one that was removed before is not")
{
    FollowStage stage;
    stage.step();
    const BodyId box = stage.addBox({Pose{{1, 0, 0}, {}}});
    visual::Light& light = stage.visual.add(visual::LightDef{});
    stage.follow(light, box);
    stage.map(); // the frame is older than the body
    stage.physics.setPose(box, {{1.01, 0, 0}, {}});
    stage.step();
    CHECK(light.worldPose().position == Vec3{1.01, 0, 0});
}

TEST_CASE("wrong things to follow are Errors that name them")
{
    FollowStage stage;
    const BodyId box = stage.addBox(), block = stage.addBlock();
    visual::Light& light = stage.visual.add(visual::LightDef{.name = "lamp"});
    CHECK_THROWS_WITH(stage.follow(light, box, {.at = FollowElement{1}}),
                      "'lamp' follows rigid body 'box': at.element must be in [0, 1), got 1");
    CHECK_THROWS_WITH(stage.follow(light, box, kOnSide), Catch::Contains("at must be an element"));
    CHECK_THROWS_WITH(stage.follow(light, block), Catch::Contains("at must be a place on its surface"));
    CHECK_THROWS_WITH(stage.follow(light, block, {.at = FollowTriangle{.triangle = 100000}}),
                      Catch::Contains("triangle must be in [0, "));
    CHECK_THROWS_WITH(stage.follow(light, block, {.at = FollowNearest{.place = {NAN, 0, 0}}}),
                      Catch::Contains("at.place"));
    CHECK_THROWS_WITH(stage.follow(light, box, {.offset = {{}, {0, 0, 0, 0}}}), Catch::Contains("length 1, got 0"));
    CHECK_THROWS_WITH(stage.follow(light, BodyId{77}), Catch::Contains("77"));

    visual::VisualServer other({.backend = visual::Backend::Null});
    CHECK_THROWS_WITH(stage.follow(other.add(visual::LightDef{}), box),
                      "follow: the transform does not belong to the visual server");
    stage.bindings.release();
    CHECK_THROWS_WITH(stage.follow(light, box), Catch::Contains("there is no visual server yet"));
}

TEST_CASE("a dressed scene follows bodies through a whole run, and again in the next run")
{
    Simulation sim({.physics = {.gravity = {}}});
    const BodyId box =
        sim.add(RigidBodyDef{.elements = {Pose{{1, 0, 0}, {}}}, .mesh = shapes::box({0.01, 0.01, 0.01})});
    std::vector<Vec3> seen;
    visual::Light* light = nullptr;
    sim.dress([&](visual::VisualServer& visual) {
        if (light) seen.push_back({}); // the scene is dressed a second time
        light = &visual.add(visual::LightDef{});
        sim.follow(*light, box);
        seen.push_back(light->worldPose().position);
    });
    for (int i = 0; i < 2; ++i) sim.run({.backend = visual::Backend::Null, .steps = 5, .freeRunning = true});
    CHECK(seen == std::vector<Vec3>{{1, 0, 0}, {}, {1, 0, 0}});
    CHECK_THROWS_AS(sim.follow(*light, box), Error); // the run is over, and the light with it
}

} // namespace follow_test
