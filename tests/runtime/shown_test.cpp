#include "shown_stage.h"

#include "filasofia/core/error.h"

namespace shown_test {

using namespace filasofia;
using namespace filasofia::runtime;

TEST_CASE("a shown surface can be hidden, shown again, given another material and removed by its id")
{
    ShownStage stage;
    const BodyId block = stage.addBlock(), box = stage.addBox();
    const ShownId first = stage.bindings.show(block, {}, stage.physics);
    const ShownId second = stage.bindings.show(block, {.visible = false}, stage.physics);
    const ShownId third = stage.bindings.show(box, {}, stage.physics);
    CHECK((first < second && second < third));
    stage.step();
    auto all = stage.drawn();
    REQUIRE(all.size() == 3);
    CHECK(all[0]->visible);
    CHECK_FALSE(all[1]->visible);

    stage.bindings.setVisible(first, false);
    stage.bindings.setVisible(second, true);
    stage.bindings.setMaterial(third, visual::MetalMaterial{.roughness = 0.7});
    stage.step();
    CHECK_FALSE(all[0]->visible);
    CHECK(all[1]->visible);
    CHECK(std::get<visual::MetalMaterial>(all[2]->material).roughness == 0.7);

    stage.bindings.remove(second);
    stage.step();
    all = stage.drawn();
    REQUIRE(all.size() == 2);
    CHECK_FALSE(all[0]->visible);
    stage.bindings.setVisible(second, true); // it was removed: nothing happens
    stage.step();
    CHECK(stage.drawn().size() == 2);
}

TEST_CASE("a body that nobody describes looks as what it is: tissue, plastic, a thread")
{
    ShownStage stage;
    const BodyId block = stage.addBlock(), box = stage.addBox();
    const BodyId rod = stage.physics.add(
        physics::RodBodyDef{.name = "thread", .points = {{0, 0, 0}, {0, 0.1, 0}}, .spacing = 0.01, .radius = 1e-3});
    for (const BodyId each : {block, box, rod}) stage.bindings.show(each, {}, stage.physics);
    stage.bindings.show(box, {.material = visual::TissueMaterial{}}, stage.physics);
    stage.step();
    const auto all = stage.drawn();
    REQUIRE(all.size() == 4);
    const auto tissue = [&](std::size_t i) { return std::get<visual::TissueMaterial>(all[i]->material); };
    CHECK(tissue(0) == visual::TissueMaterial{});
    CHECK(tissue(1) == visual::plainMaterial({0.34, 0.35, 0.37}));
    CHECK(all[2]->material == visual::Material{visual::ThreadMaterial{.pitch = 5e-3}});
    // Its pattern lies where it is straight along x, from 0 on.
    CHECK(all[2]->geometry.rest.front().x == 0.0F);
    CHECK(std::hypot(all[2]->geometry.rest.front().y, all[2]->geometry.rest.front().z) == Approx(1e-3));
    CHECK(all[2]->geometry.rest.back().x == Approx(0.1));
    CHECK(tissue(3) == visual::TissueMaterial{}); // what was asked for
}

TEST_CASE("changes of a shown surface hold for the next visual server too")
{
    ShownStage stage;
    const ShownId id = stage.bindings.show(stage.addBlock(), {}, stage.physics);
    stage.bindings.setVisible(id, false); // before anything is drawn
    stage.bindings.setMaterial(id, visual::MetalMaterial{});
    stage.step();
    CHECK_FALSE(stage.only().visible);
    stage.bindings.release();
    visual::VisualServer next({.backend = visual::Backend::Null});
    stage.bindings.addPending(next);
    CHECK(next.statistics().bodies == 1);
    stage.bindings.remove(id);
    stage.bindings.addPending(next);
    CHECK(next.statistics().bodies == 0);
}

TEST_CASE("an unknown id and an invalid material are Errors at once")
{
    ShownStage stage;
    const ShownId id = stage.bindings.show(stage.addBlock(), {}, stage.physics);
    CHECK_THROWS_WITH(stage.bindings.setVisible({}, true), "setVisible: nothing shown has the id 0");
    CHECK_THROWS_WITH(stage.bindings.remove({id.value + 1}), "unshow: nothing shown has the id 2");
    CHECK_THROWS_WITH(stage.bindings.setMaterial(id, visual::MetalMaterial{.roughness = 7}),
                      Catch::Contains("roughness") && Catch::Contains("got 7"));
}

TEST_CASE("every element of a rigid body answers to the one id of its show()")
{
    ShownStage stage;
    const ShownId id = stage.bindings.show(stage.addBox({Pose{}, Pose{{1, 0, 0}, {}}}), {}, stage.physics);
    stage.step();
    stage.bindings.setVisible(id, false);
    stage.step();
    for (const auto* each : stage.drawn()) CHECK_FALSE(each->visible);
    stage.bindings.remove(id);
    stage.step();
    CHECK(stage.drawn().empty());
}

TEST_CASE("a hidden surface is not deformed, and is in place as soon as it is shown")
{
    ShownStage stage;
    const BodyId block = stage.addBlock();
    const ShownId id = stage.bindings.show(block, {.visible = false}, stage.physics);
    stage.physics.setGravity({0, -9, 0});
    for (int i = 0; i < 3; ++i) stage.step();
    CHECK(stage.only().vertexCalls == 0);
    stage.bindings.setVisible(id, true);
    stage.map();
    CHECK(stage.only().vertexCalls == 1);
    CHECK(stage.only().geometry.vertices.low.y < ShownStage::mesh()->nodes.front().y);
}

TEST_CASE("a thousand bodies are added and removed, and nothing is left of them")
{
    ShownStage stage;
    std::vector<BodyId> bodies;
    for (int i = 0; i < 1000; ++i) {
        const BodyId box = stage.addBox();
        const ShownId id = stage.bindings.show(box, {}, stage.physics);
        if (i % 3 == 0) stage.bindings.remove(id);
        bodies.push_back(box);
    }
    stage.step();
    CHECK(stage.visual.statistics().bodies == 666);
    for (const BodyId box : bodies) stage.physics.remove(box);
    stage.step();
    CHECK(stage.visual.statistics().bodies == 0);
}

TEST_CASE("the box around what is seen now is where the bodies are now")
{
    ShownStage stage;
    const BodyId box = stage.addBox();
    const ShownId id = stage.bindings.show(box, {}, stage.physics);
    stage.physics.setPose(box, {{3, 0, 0}, {}});
    stage.step();
    CHECK(stage.bindings.boundsNow().low.x == Approx(2.99));
    CHECK(stage.bindings.bounds().low.x == Approx(-0.01));
    stage.bindings.setVisible(id, false);
    stage.step();
    CHECK(geometry::isEmpty(stage.bindings.boundsNow()));
}

} // namespace shown_test
