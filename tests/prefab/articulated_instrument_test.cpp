#include "filasofia/prefab/articulated_instrument.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/core/units.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/assets.h"

#include <catch2/catch.hpp>

namespace articulated_instrument_test {

using namespace filasofia;
using prefab::ArticulatedInstrument;
using prefab::ArticulatedInstrumentDef;
using prefab::InstrumentKind;
using runtime::Simulation;

namespace {

runtime::SimulationDef weightless() { return {.physics = {.gravity = {}}}; }

/// A block of 2 x 2 x 4 mm within reach of closed jaws, pinned at its far end.
BodyId addBlock(Simulation& sim, bool cut = false)
{
    physics::SoftBodyDef def{.name = "block",
                             .mesh = geometry::shapes::block({2_mm, 2_mm, 4_mm}, {2, 2, 4}),
                             .pose = {{0, 0, -4.5_mm}, {}},
                             .material = physics::FemMaterial{.youngModulus = 30_kPa},
                             .collision = {{.proximity = 0.1_mm}},
                             .friction = 0.8,
                             .dynamicTopology = cut};
    def.rayleigh.mass = 10.0;
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, -6.4_mm}}}};
    return sim.add(def);
}

void run(Simulation& sim, int steps) { sim.run({.headless = true, .backend = visual::Backend::Null, .steps = steps}); }

/// The mean of the nodes at the block's near end.
Vec3 nearEnd(Simulation& sim, BodyId block)
{
    const auto frame = sim.physics().latest();
    const auto& nodes = frame->softBody(block)->positions;
    static const auto rest = geometry::shapes::block({2_mm, 2_mm, 4_mm}, {2, 2, 4});
    Vec3 sum = {};
    int count = 0;
    for (std::size_t i = 0; i < rest->nodes.size(); ++i)
        if (rest->nodes[i].z > 1.9_mm) {
            sum += nodes[i];
            ++count;
        }
    return sum / count;
}

} // namespace

TEST_CASE("jaws close on a soft block and hold it, it follows, and opening lets it go")
{
    Simulation sim(weightless());
    const BodyId block = addBlock(sim);
    std::vector<std::pair<BodyId, bool>> grasps;
    ArticulatedInstrument forceps(sim, {.name = "forceps", .opening = 1.0, .onGrasp = [&](BodyId body, bool on) {
                                            grasps.emplace_back(body, on);
                                        }});
    run(sim, 20);
    CHECK(forceps.opening() == Approx(1.0).epsilon(1e-6));
    CHECK_FALSE(forceps.holding());

    forceps.close();
    run(sim, 800);
    REQUIRE(forceps.holding() == block);
    REQUIRE(grasps == std::vector<std::pair<BodyId, bool>>{{block, true}});
    CHECK(forceps.opening() > 0.05); // the block is between the jaws
    const Vec3 before = nearEnd(sim, block);

    // Moved aside by 1 mm, the near end follows; the far end is pinned, so the block pulls back.
    double start = sim.physics().latest()->time;
    sim.everyStep([&](double time) { forceps.move({{1_mm * std::clamp((time - start) / 0.2, 0.0, 1.0), 0, 0}, {}}); });
    run(sim, 400);
    CHECK(nearEnd(sim, block).x - before.x > 0.5_mm);
    CHECK(forceps.pull() > 1_mN);

    forceps.open();
    CHECK_FALSE(forceps.holding());
    CHECK(grasps.back() == std::pair{block, false});
    run(sim, 600);
    CHECK(forceps.opening() == Approx(1.0).epsilon(1e-6));
    CHECK(sim.physics().latest()->attachments.size() == 1); // the block's own
    CHECK(std::abs(nearEnd(sim, block).x - before.x) < 0.3_mm);
}

TEST_CASE("jaws grasp what is between them, and not what touches their shaft")
{
    Simulation sim(weightless());
    // Two blocks of one body: one reaches between the jaws, the other stands beside the shaft without touching it, but
    // as near as contacts reach. Both are pinned at their far ends.
    const auto block = geometry::shapes::block({2_mm, 2_mm, 4_mm}, {2, 2, 4});
    auto both = std::make_shared<geometry::TetMesh>(*block);
    const auto count = static_cast<int>(block->nodes.size());
    const auto shaft = physics::loadMesh(runtime::asset("meshes/hysteroscopy/tool_shaft_collision.obj"), "shaft");
    const double radius = geometry::boxAround(shaft->vertices).high.x;
    for (const Vec3 p : block->nodes) both->nodes.push_back({p.z - 2_mm - 0.1_mm - radius, p.y, p.x + 14.5_mm});
    for (const auto& t : block->tetrahedra)
        both->tetrahedra.push_back({t[0] + count, t[2] + count, t[1] + count, t[3] + count});
    physics::SoftBodyDef def{.name = "tissue",
                             .mesh = std::shared_ptr<const geometry::TetMesh>(both),
                             .pose = {{0, 0, -4.5_mm}, {}},
                             .material = physics::FemMaterial{.youngModulus = 30_kPa},
                             .collision = {{.proximity = 0.1_mm}},
                             .friction = 0.8};
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, -6.4_mm}}},
                       {.box = geometry::Box{{-1, -1, 1_mm}, {-4_mm - radius, 1, 1}}}};
    const BodyId tissue = sim.add(def);
    ArticulatedInstrument forceps(sim, {.opening = 1.0});
    forceps.close();
    run(sim, 800);
    REQUIRE(forceps.holding() == tissue);
    const auto beside = [&] {
        return sim.physics().latest()->softBody(tissue)->positions[static_cast<std::size_t>(count)];
    };
    const Vec3 before = beside();
    const double start = sim.physics().latest()->time;
    sim.everyStep([&](double time) { forceps.move({{1_mm * std::clamp((time - start) / 0.2, 0.0, 1.0), 0, 0}, {}}); });
    run(sim, 300);
    CHECK(forceps.holding() == tissue);
    CHECK(distance(beside(), before) < 0.01_mm);
}

TEST_CASE("a grasp breaks beyond its break force, and holds again only after it was opened")
{
    Simulation sim(weightless());
    const BodyId block = addBlock(sim);
    ArticulatedInstrument forceps(sim, {.opening = 1.0, .breakForce = 20_mN});
    forceps.close();
    run(sim, 800);
    REQUIRE(forceps.holding() == block);
    const double start = sim.physics().latest()->time;
    sim.everyStep([&](double time) { forceps.move({{0, 0, 8_mm * std::clamp((time - start) / 0.4, 0.0, 1.0)}, {}}); });
    run(sim, 500);
    CHECK_FALSE(forceps.holding());
}

TEST_CASE(
    "with a finite grip stiffness two instruments hold one rigid body without fighting, and one gives it to the other")
{
    Simulation sim({.physics = {.gravity = {}}});
    physics::RigidBodyDef rod{.name = "rod",
                              .mesh = geometry::shapes::box({40_mm, 3_mm, 3_mm}, {8, 1, 1}),
                              .dynamic = true,
                              .mass = physics::Density{1100.0},
                              .linearDamping = 2.0,
                              .angularDamping = 10.0,
                              .collision = {{}},
                              .friction = 0.6};
    const BodyId held = sim.add(rod);
    const auto at = [](double x) {
        return prefab::ArticulatedInstrumentDef{.name = x < 0.0 ? "left" : "right",
                                                .kind = prefab::InstrumentKind::LaparoscopicGrasper,
                                                .pose = {{x, 0.3_mm, 16_mm}, {}},
                                                .opening = 0.5,
                                                .gripStiffness = 1000.0};
    };
    ArticulatedInstrument left(sim, at(-9_mm)), right(sim, at(9_mm));
    CHECK(distance(left.grip(), {-9_mm, 0.3_mm, 16_mm}) < 1e-12); // its pivot, while it holds nothing
    double most = 0.0;
    const auto run = [&](int steps) {
        for (int i = 0; i < steps; ++i) {
            sim.run({.headless = true, .backend = visual::Backend::Null, .steps = 1});
            most = 0.0;
            for (const frame::Contact& each : sim.physics().latest()->contacts) most += each.normalForce;
        }
    };
    left.close();
    run(600);
    REQUIRE(left.holding() == held);
    const auto middle = [&] { return sim.physics().latest()->rigidBody(held)->poses[0].position; };
    CHECK(distance(left.grip(), middle()) < 0.5_mm); // where the rigid body's own origin is
    CHECK(most < 0.1);                               // the spring alone holds it
    right.close();
    run(600);
    REQUIRE(right.holding() == held);
    CHECK(left.holding() == held);
    CHECK(most < 0.1);
    left.open();
    run(300);
    CHECK(!left.holding());
    const Vec3 before = middle();
    right.move({{9_mm, 5.3_mm, 16_mm}, {}});
    run(300);
    CHECK(distance(middle(), before + Vec3{0, 5_mm, 0}) < 0.5_mm);
}

TEST_CASE("closed jaws with nothing between them touch and hold nothing")
{
    for (const auto kind : {InstrumentKind::Forceps, InstrumentKind::Grasper, InstrumentKind::Scissors,
                            InstrumentKind::NeedleDriver, InstrumentKind::PickUps, InstrumentKind::SutureScissors}) {
        Simulation sim(weightless());
        ArticulatedInstrument tool(sim, {.kind = kind, .opening = 0.5});
        tool.close();
        run(sim, 800);
        CHECK(tool.opening() == Approx(0.0).margin(1e-3));
        CHECK_FALSE(tool.holding());
    }
}

TEST_CASE("the blades of scissors cut what may be cut")
{
    Simulation sim(weightless());
    addBlock(sim, true);
    double area = 0.0; // [m^2]
    sim.on<runtime::CutEvent>([&](const runtime::CutEvent& cut) { area += cut.rupture.area; });
    ArticulatedInstrument scissors(sim, {.kind = InstrumentKind::Scissors, .opening = 1.0});
    scissors.close();
    run(sim, 900);
    // The edges sweep the plane x = 0 from z = -1 mm to -6.4 mm; the block's section there is 2 mm x 4 mm.
    CHECK(area > 2e-6);
    CHECK(area < 9e-6);
    CHECK_FALSE(scissors.holding());
    CHECK(sim.run({.headless = true, .backend = visual::Backend::Null, .steps = 1}).bluntBlades.empty());
}

TEST_CASE("scissors on what cannot be cut: a warning once, and a line in the summary")
{
    std::vector<std::string> lines;
    setLogSink([&](LogLevel, std::string_view line) { lines.emplace_back(line); });
    const std::string expected =
        "blade of 'scissors' met body 'block', which has no dynamicTopology: it pushes and does not cut";
    Simulation sim(weightless());
    addBlock(sim, false);
    ArticulatedInstrument scissors(sim, {.name = "scissors", .kind = InstrumentKind::Scissors, .opening = 1.0});
    for (int times = 0; times < 2; ++times) {
        scissors.close();
        run(sim, 700);
        scissors.open();
        run(sim, 300);
    }
    const runtime::RunReport report = sim.run({.headless = true, .backend = visual::Backend::Null, .steps = 1});
    setLogSink({});
    CHECK(std::ranges::count(lines, expected) == 1);
    CHECK(report.bluntBlades == std::vector<std::string>{expected});
    CHECK_THAT(runtime::summary(report), Catch::Contains(expected + "\n"));
}

TEST_CASE("scissors on a thread that cannot be cut: the same warning, and nothing is cut")
{
    std::vector<std::string> lines;
    setLogSink([&](LogLevel, std::string_view line) { lines.emplace_back(line); });
    Simulation sim(weightless());
    physics::RodBodyDef def{.name = "thread", .points = {{-5_mm, 0, -4_mm}, {5_mm, 0, -4_mm}}, .spacing = 1_mm};
    def.collision = physics::RodCollision{};
    def.attachments = {{.nodes = {0, 10}}};
    sim.add(def);
    ArticulatedInstrument scissors(sim, {.name = "scissors", .kind = InstrumentKind::Scissors, .opening = 1.0});
    scissors.close();
    run(sim, 700);
    setLogSink({});
    CHECK(lines == std::vector<std::string>{"blade of 'scissors' met body 'thread', which has no dynamicTopology: it "
                                            "pushes and does not cut"});
    CHECK(sim.physics().latest()->softBodies.front().cutEdges.empty());
}

TEST_CASE("a jaw that is fixed to the shaft stays with it")
{
    Simulation sim(weightless());
    ArticulatedInstrumentDef def{.name = "one jaw", .opening = 1.0};
    def.jaws = {{.opensBy = 30_deg}, {.axis = {-1, 0, 0}, .opensBy = 0.0}};
    ArticulatedInstrument tool(sim, def);
    run(sim, 2);
    CHECK(sim.physics().latest()->rigidBody(tool.body())->poses.size() == 2);
}

TEST_CASE("a wrong instrument Def is refused with its name, the field and the bound")
{
    Simulation sim;
    using Def = ArticulatedInstrumentDef;
    const auto refused = [&](const Def& def, const char* why) {
        CHECK_THROWS_WITH(ArticulatedInstrument(sim, def), Catch::Contains(why));
    };
    refused({.name = "tool", .opening = 1.5}, "instrument 'tool': opening must be in [0, 1], got 1.5");
    refused({.closingTorque = 0.0}, "closingTorque must be > 0 N m, got 0");
    refused({.jaws = {{}, {}, {}}}, "jaws must have one or two entries, got 3");
    refused({.jaws = {{.opensBy = 0.0}}}, "at least one must have opensBy > 0");
    refused({.jaws = {{.axis = {}}}}, "jaws[0].axis must have a length > 0");
    ArticulatedInstrument tool(sim, {.name = "tool"});
    CHECK_THROWS_WITH(tool.open(-0.1), Catch::Contains("open must be in [0, 1], got -0.1"));
    CHECK_THROWS_WITH(tool.close(0.0), Catch::Contains("torque must be > 0 N m, got 0"));
}

} // namespace articulated_instrument_test
