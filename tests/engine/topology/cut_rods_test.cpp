#include "filasofia/core/log.h"

#include "engine/rods.h"

namespace cut_rods_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::engine::rods;
using namespace filasofia::physics;

TEST_CASE("a cut is part of a rod's state: hash, saved state and reset have it, and a piece can be removed")
{
    Stage stage;
    stage.world.scene().gravity = kGravity;
    RodBodyDef def = thread();
    def.dynamicTopology = true;
    def.collision = RodCollision{};
    const BodyId rod = stage.add(def);
    stage.run(20, 1e-3);
    const auto start = stage.world.save();
    const auto cut = [&](int edge) {
        stage.world.scene().soft[0].topology.cutEdges = {{edge, 0.5}};
        return stage.step(1e-3).topology;
    };
    stage.step(1e-3);
    const std::uint64_t whole = stage.world.hash();
    stage.world.restore(*start);
    CHECK(cut(20).ruptures.size() == 1);
    CHECK(stage.world.hash() != whole);
    CHECK(cut(20).ruptures.empty());
    CHECK(cut(30).ruptures.at(0).detached.at(0).piece == 2);
    REQUIRE(stage.model().pieces.size() == 3);
    CHECK(stage.model().pieces[0].held);
    CHECK_FALSE(stage.model().pieces[1].held);
    CHECK(stage.model().collision[0].shape->edges.size() == 48);
    const auto saved = stage.world.save();
    stage.run(50, 1e-3);
    const std::uint64_t hash = stage.world.hash();
    CHECK(stage.soft().x[25].y < 0.05 - 0.008);
    stage.world.restore(*saved);
    stage.run(50, 1e-3);
    CHECK(stage.world.hash() == hash);

    stage.post(RemovePiece{rod, 1});
    stage.step(1e-3);
    const Vec3 place = stage.soft().x[25];
    CHECK(stage.model().removed == std::set{1});
    CHECK(stage.model().pieces.size() == 2);
    stage.run(10, 1e-3);
    CHECK(stage.soft().x[25] == place);
    CHECK(stage.soft().v[35].y < -0.5); // the other one goes on falling
    for (const auto& [a, b] : stage.model().collision[0].shape->edges) CHECK((b <= 20 || a >= 31));
    stage.post(RemovePiece{rod, 1});
    CHECK(stage.step(1e-3).topology.noPiece == 1);
    int lost = 0;
    for (int i = 0; i < 400 && lost == 0; ++i) lost += stage.step(5e-3).topology.lost; // it falls out of the scene
    CHECK(lost == 1);
    CHECK(stage.model().pieces.size() == 1);

    stage.post(Reset{});
    stage.step(0.0);
    CHECK(stage.soft().x == stage.model().rest);
    CHECK(stage.model().pieces.empty());
    CHECK(stage.model().removed.empty());
    CHECK(std::ranges::count(stage.model().pins.hard, true) == 2);
    stage.run(21, 1e-3);
    Stage again;
    again.world.scene().gravity = kGravity;
    again.add(def);
    again.run(21, 1e-3);
    CHECK(stage.soft().x == again.soft().x);
}

TEST_CASE("a node that cuts leave alone is still stopped by a table")
{
    Stage stage;
    stage.world.scene().gravity = kGravity;
    RodBodyDef def = thread(false);
    def.dynamicTopology = true;
    def.collision = RodCollision{};
    for (Vec3& each : def.points) each.y = 2e-3;
    stage.add(table());
    stage.add(def);
    stage.step(1e-3);
    stage.world.scene().soft[0].topology.cutEdges = {{24, 0.5}, {25, 0.5}};
    stage.run(500, 1e-3);
    for (Vec3 x : stage.soft().x) CHECK(x.y > 0.8 * 0.3e-3);
    CHECK(stage.soft().x[25].y < 0.5e-3);
}

TEST_CASE("a force that tears a thread neither throws the light end about nor disturbs the rest, and the log says so")
{
    Stage stage;
    RodBodyDef def{.name = "thread", .points = {{0, 0, 0}, {0.1, 0, 0}}};
    def.spacing = 1e-3;
    def.radius = 0.15e-3;
    def.youngModulus = 0.3e9;
    def.gravity = false;
    def.dynamicTopology = true;
    def.breakForce = 3.0;
    def.attachments = {{.nodes = {0}}};
    const BodyId rod = stage.add(def);
    std::string warnings;
    setLogSink([&](LogLevel, std::string_view line) { warnings += text(line, "\n"); });
    const auto pull = [&](double force) { stage.post(SetForces{rod, {{100, {force, 0, 0}}}}); };
    pull(2.9);
    std::size_t tears = 0;
    physics::StepReport report;
    int lost = 0;
    const auto run = [&](int steps) {
        for (int i = 0; i < steps; ++i) {
            report = stage.step(1e-3);
            CHECK((report.flags & static_cast<std::uint32_t>(StepFlag::Undone)) == 0);
            tears += report.topology.ruptures.size();
            lost += report.topology.lost;
            for (std::size_t k = 0; lost == 0 && k < stage.soft().v.size(); ++k)
                CHECK(length(stage.soft().v[k]) < 101.0);
        }
    };
    run(300);
    CHECK(tears == 0);
    pull(3.1);
    run(300);
    setLogSink({});
    CHECK(tears == 1);
    CHECK(lost == 1); // it has left the scene
    CHECK(std::abs(stage.soft().x[90].x) < 0.11);
    CHECK(warnings.starts_with("body 'thread' has come apart, and forces of 3.1 N still act on a loose piece of "));
    CHECK(std::ranges::count(warnings, '\n') == 1);
}

} // namespace cut_rods_test
