#include "engine/contact/attachment_scene.h"

namespace attachments_end_test {

using namespace filasofia;
using namespace filasofia::engine;
using physics::AttachmentDef;

TEST_CASE("released nodes are free in the next step, whether pins or a later attachment held them")
{
    for (const bool pins : {true, false})
        for (const double stiffness : {physics::kHard, 50.0}) {
            physics::SoftBodyDef def = cube();
            AttachmentDef hold{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}, .stiffness = stiffness};
            if (pins) def.attachments = {hold};
            AttachmentScene scene(def);
            scene.stage.post(physics::SetGravity{{0, -10, 0}});
            const AttachmentId id = pins ? AttachmentId{1} : scene.attach(hold);
            scene.stage.run(100, 1e-3);
            REQUIRE(scene.held(id) != nullptr);
            CHECK(scene.held(id)->force.y > 0.02);
            const auto momentum = [&] {
                double sum = 0.0;
                for (std::size_t i = 0; i < scene.stage.soft().v.size(); ++i)
                    sum += scene.stage.model().masses[i] * scene.stage.soft().v[i].y;
                return sum;
            };
            const double before = momentum();
            scene.stage.post(physics::Release{id});
            scene.stage.step(1e-3);
            CHECK(scene.held(id) == nullptr);
            CHECK(momentum() - before == Approx(-10.0 * 0.008 * 1e-3).epsilon(0.02)); // its weight and nothing else
            scene.stage.post(physics::Release{id});
            scene.stage.step(1e-3); // releasing it again has no effect
        }
}

TEST_CASE("if one of two groups of pins on a node is released, the other still pins it")
{
    physics::SoftBodyDef def = cube();
    def.attachments = {{.nodes = {0, 1, 2, 3, 4, 5}}, {.nodes = {3, 4, 5, 6, 7, 8}}}; // the left face
    AttachmentScene scene(def);
    scene.stage.post(physics::SetGravity{{0, -10, 0}});
    scene.stage.run(500, 1e-3);
    const double weight = 0.08;
    CHECK(length(scene.held({1})->force + scene.held({2})->force - Vec3{0, weight, 0}) < 0.02 * weight);
    scene.stage.post(physics::Release{{1}});
    scene.stage.step(1e-3);
    CHECK(scene.stage.model().pins.hard[3]);
    CHECK_FALSE(scene.stage.model().pins.hard[0]);
    scene.stage.post(physics::SetMaterial{{1}, physics::FemMaterial{}, nullptr});
    scene.stage.run(100, 1e-3);
    CHECK(scene.stage.soft().x[3] == scene.stage.model().rest[3]);
    CHECK(scene.stage.soft().x[0] != scene.stage.model().rest[0]);
}

TEST_CASE("a material set after pins were released does not restore them")
{
    physics::SoftBodyDef def = cube();
    def.attachments = {{.nodes = {0, 1}}};
    AttachmentScene scene(def);
    scene.stage.post(physics::Release{{1}});
    scene.stage.post(physics::SetMaterial{{1}, physics::FemMaterial{}, scene.stage.world.build(def)});
    scene.stage.post(physics::SetGravity{{0, -10, 0}});
    scene.stage.run(100, 1e-3);
    CHECK(scene.stage.soft().x[0].y == Approx(-0.05).epsilon(0.02));
}

TEST_CASE("an attachment breaks if its force exceeds breakForce, and reports that once")
{
    AttachmentScene scene(cube());
    const AttachmentId id = scene.attach({.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}, .breakForce = 0.05});
    for (int i = 0; i < 1000 && !scene.held(id); ++i) scene.stage.step(1e-3);
    int reports = 0;
    for (int i = 0; i < 800; ++i) { // up to 0.1 N
        std::vector<physics::NodalForce> forces;
        for (int node = 0; node < 27; ++node) forces.push_back({node, {i * 0.1 / 27 / 800, 0, 0}});
        scene.stage.post(physics::SetForces{{1}, forces});
        if (scene.held(id) && scene.held(id)->broken) scene.stage.step(0.0); // not reported again while paused
        if (scene.held(id) && scene.held(id)->broken) FAIL("reported twice");
        scene.stage.step(1e-3);
        if (const auto* now = scene.held(id); now && now->broken) {
            ++reports;
            CHECK(length(now->force) > 0.05);
            CHECK(length(now->force) < 0.0525);
        }
    }
    CHECK(reports == 1);
    CHECK(scene.state().attachments.empty());
    CHECK(scene.state().attachmentForces.empty());
}

TEST_CASE("pins with a breakForce can break")
{
    physics::SoftBodyDef def = cube();
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}, .breakForce = 0.02}};
    AttachmentScene scene(def);
    scene.stage.post(physics::SetGravity{{0, -10, 0}}); // 0.08 N
    scene.stage.run(100, 1e-3);
    CHECK(scene.state().attachmentReports.empty());
    CHECK(scene.stage.soft().v[0].y < -0.1);
}

TEST_CASE("removing either body removes the attachment between them")
{
    for (const std::uint32_t gone : {1u, 2u, 3u}) {
        AttachmentScene scene;
        scene.stage.add(cube(0.02));
        scene.stage.add(rigidBox({0.05, 0.01, 0.01}, {0.01, 0.01, 0.01}, true));
        scene.attach({.to = {2}});
        scene.attachRigid({3}, {.to = {2}});
        scene.stage.run(3, 1e-3);
        REQUIRE(scene.state().attachmentReports.size() == 2);
        scene.stage.post(physics::RemoveBody{{gone}});
        scene.stage.run(3, 1e-3);
        CHECK(scene.state().attachmentReports.size() == (gone == 2 ? 0u : 1u));
        CHECK(scene.state().attachments.size() == scene.state().attachmentReports.size());
        for (const frame::Attachment& each : scene.state().attachmentReports)
            CHECK((each.body != BodyId{gone} && each.to != BodyId{gone}));
    }
}

TEST_CASE("a reset keeps attachments and clears their forces")
{
    AttachmentScene scene;
    scene.stage.add(rigidBox({0.03, 0.01, 0.01}, {0.01, 0.01, 0.01}, true));
    scene.attach({.within = 1e-4, .to = {2}});
    scene.attach({.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}});
    scene.stage.post(physics::SetGravity{{0, -10, 0}});
    scene.stage.step(1e-3);
    const std::uint64_t first = scene.stage.world.hash();
    scene.stage.run(50, 1e-3);
    scene.stage.post(physics::Reset{});
    scene.stage.step(0.0);
    for (const auto& forces : scene.state().attachmentForces)
        for (Vec3 force : forces) CHECK(force == Vec3{});
    scene.state().step = 0;
    scene.state().time = 0.0;
    scene.stage.step(1e-3);
    CHECK(scene.stage.world.hash() == first);
    CHECK(scene.state().attachmentReports.size() == 2);
}

} // namespace attachments_end_test
