#include "engine/contact/attachment_scene.h"

namespace attach_removed_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr Vec3 kFragment{0.05, 0, 0};

/// A cube of 2 cm, and 3 cm beside it a loose tetrahedron of 2 mm that has been removed.
struct RemovedScene : AttachmentScene {
    RemovedScene() : AttachmentScene(cubeAndFragment())
    {
        stage.step(0.0);
        REQUIRE(stage.model().pieces.size() == 2);
        stage.post(physics::RemovePiece{{1}, 1});
        REQUIRE(stage.step(1e-3).topology.noPiece == 0);
    }
    static physics::SoftBodyDef cubeAndFragment()
    {
        geometry::TetMesh mesh = boxMesh({2, 2, 2}, {0.02, 0.02, 0.02});
        const auto first = static_cast<int>(mesh.nodes.size());
        for (Vec3 corner : {Vec3{}, Vec3{2e-3, 0, 0}, Vec3{0, 2e-3, 0}, Vec3{0, 0, 2e-3}})
            mesh.nodes.push_back(kFragment + corner);
        mesh.tetrahedra.push_back({first, first + 1, first + 2, first + 3});
        return {.name = "cube", .mesh = shared(std::move(mesh)), .dynamicTopology = true};
    }
    [[nodiscard]] int fragmentNode() { return static_cast<int>(stage.model().rest.size()) - 4; }
};

} // namespace

TEST_CASE("a removed piece is not attached by node numbers, by a region or by the distance to a body")
{
    RemovedScene scene;
    scene.stage.add(rigidBox(kFragment, {0.002, 0.002, 0.002}, true)); // around the removed piece
    for (const physics::AttachmentDef& def :
         {physics::AttachmentDef{.nodes = {scene.fragmentNode()}, .to = {2}},
          physics::AttachmentDef{.ball = physics::Ball{kFragment, 0.01}, .to = {2}},
          physics::AttachmentDef{.box = geometry::Box{kFragment, kFragment + Vec3{1, 1, 1}}, .to = {2}},
          physics::AttachmentDef{.within = 1e-3, .to = {2}}, physics::AttachmentDef{.to = {2}}}) {
        scene.attach(def);
        CHECK(scene.stage.step(1e-3).has(physics::StepFlag::NothingAttached));
    }
    CHECK(scene.state().attachments.empty());
    CHECK(scene.warnings.size() == 5);
    const double mass = scene.state().rigid[0].model.inertias[0].mass;
    scene.stage.post(physics::SetWrench{{2}, 0, {mass, 0, 0}, {}}); // 1 m/s^2
    scene.stage.run(100, 1e-3);
    CHECK(scene.state().rigid[0].state.velocities[0].x == Approx(0.1));         // the tool is free
    scene.attach({.ball = physics::Ball{{0.02, 0.02, 0.02}, 1e-3}, .to = {2}}); // the remaining cube can be attached
    CHECK_FALSE(scene.stage.step(1e-3).has(physics::StepFlag::NothingAttached));
}

TEST_CASE("a pair of nodes of which one is gone is left out, on either side")
{
    RemovedScene scene;
    scene.stage.add(cube(0.03));
    scene.stage.step(0.0);
    const int gone = scene.fragmentNode();
    const auto attach = [&](BodyId body, const physics::AttachmentDef& def) {
        scene.stage.post(physics::Attach{{++scene.stage.lastAttachment}, body, def});
        return scene.stage.step(1e-3).has(physics::StepFlag::NothingAttached);
    };
    CHECK_FALSE(attach({1}, {.nodes = {gone, 8}, .to = {2}, .toNodes = {0, 1}}));
    CHECK_FALSE(attach({2}, {.nodes = {0, 1}, .to = {1}, .toNodes = {gone, 8}}));
    REQUIRE(scene.state().attachments.size() == 2);
    for (const Attachment& each : scene.state().attachments) REQUIRE(each.pairs.size() == 1);
    CHECK(scene.state().attachments[0].pairs[0][0].nodes[0].node == 8);
    CHECK(scene.state().attachments[1].pairs[0][1].nodes[0].node == 8);
    CHECK(attach({1}, {.nodes = {gone}, .to = {2}, .toNodes = {0}}));
    CHECK(attach({2}, {.nodes = {0}, .to = {1}, .toNodes = {gone}}));
    CHECK(scene.state().attachments.size() == 2);
    REQUIRE(scene.warnings.size() == 2);
    CHECK_THAT(scene.warnings[0], Catch::Contains("attachment.toNodes: no node is there"));
}

TEST_CASE("no body is attached to a removed piece: the nearest remaining one is used")
{
    for (const bool far : {false, true}) {
        RemovedScene scene;
        scene.stage.add(rigidBox(kFragment, {0.002, 0.002, 0.002}, true));
        scene.stage.add(cube(kFragment.x));
        scene.stage.step(0.0);
        if (far)
            for (std::size_t i = 0; i < 4; ++i)
                scene.stage.soft().x[static_cast<std::size_t>(scene.fragmentNode()) + i].y = 9;
        scene.attachRigid({2}, {.points = {{1e-4, 1e-4, 1e-4}}, .to = {1}});
        scene.attachRigid({2}, {.to = {1}});
        for (const physics::AttachMode mode : {physics::AttachMode::Nearest, physics::AttachMode::Barycentric})
            scene.stage.post(
                physics::Attach{{++scene.stage.lastAttachment}, {3}, {.nodes = {0}, .to = {1}, .mode = mode}});
        scene.stage.step(1e-3);
        REQUIRE(scene.state().attachments.size() == 4);
        for (const Attachment& each : scene.state().attachments)
            for (const auto& pair : each.pairs)
                for (const NodeWeight& held : pair[1].nodes) CHECK(held.node < scene.fragmentNode());
        for (const auto& pair : scene.state().attachments[1].pairs) CHECK(length(pair[0].place) < 0.02);
    }
}

} // namespace attach_removed_test
