#include "shown_stage.h"

#include "filasofia/filasofia.h"

namespace paint_test {

using namespace filasofia;
using namespace filasofia::runtime;
using visual::SurfaceState;

namespace {

constexpr SurfaceState kBlood{1.0, 0.0, 0.0};

/// The blood at each drawn vertex.
std::vector<int> blood(const visual::NullBackend::Body& body)
{
    std::vector<int> all;
    for (const visual::PackedState& state : body.states) all.push_back(state[0]);
    return all;
}

int bloody(const visual::NullBackend::Body& body)
{
    const std::vector<int> all = blood(body);
    return static_cast<int>(std::count_if(all.begin(), all.end(), [](int b) { return b > 0; }));
}

} // namespace

TEST_CASE("a mark is full up to half of its radius, fades to its rim, and reaches no farther")
{
    std::vector<Vec3> rest;
    for (int i = 0; i <= 10; ++i) rest.push_back({0.001 * i, 0, 0});
    std::vector<SurfaceState> states(rest.size());
    CHECK(paint(rest, {}, 0.008, {0.8, 0.0, 1.0}, PaintMode::Add, states) == 8);
    CHECK(states[4] == SurfaceState{0.8, 0.0, 1.0});
    CHECK(states[6].blood == Approx(0.4)); // the middle of the smooth step
    CHECK(states[8] == SurfaceState{});
    for (std::size_t i = 1; i < states.size(); ++i) CHECK(states[i].blood <= states[i - 1].blood);
}

TEST_CASE("added marks come out the same in any order and number, a replacing one washes off")
{
    const std::vector<Vec3> rest{{0, 0, 0}, {0.003, 0, 0}, {0.006, 0, 0}};
    std::vector<SurfaceState> one(3), other(3);
    const auto mark = [&](std::vector<SurfaceState>& on, double x, const SurfaceState& state) {
        paint(rest, {x, 0, 0}, 0.005, state, PaintMode::Add, on);
    };
    mark(one, 0.0, kBlood);
    mark(one, 0.006, {0.3, 0.5, 0.0});
    mark(other, 0.006, {0.3, 0.5, 0.0});
    mark(other, 0.0, kBlood);
    mark(other, 0.0, kBlood);
    CHECK(one == other);
    paint(rest, {}, 0.005, {0.0, 0.0, 1.0}, PaintMode::Replace, one);
    CHECK(one[0] == SurfaceState{0.0, 0.0, 1.0});
}

TEST_CASE("a deformed surface is painted where it is now, and nowhere when it is too far")
{
    const geometry::TriangleMesh rest{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {}};
    const std::vector<Vec3> now{{5, 0, 0}, {7, 0, 0}, {5, 2, 0}}; // twice as large, elsewhere
    const auto found = restPlace(rest, now, {6, 0.5, 0.1}, 0.2);
    REQUIRE(found);
    CHECK(distance(*found, {0.5, 0.25, 0}) < 1e-12);
    CHECK_FALSE(restPlace(rest, now, {6, 0.5, 0.3}, 0.2));
}

TEST_CASE("blood on a soft body stays where it was painted while the body moves, on every surface of it")
{
    ShownStage stage;
    const BodyId block = stage.addBlock();
    stage.bindings.show(block, {}, stage.physics);
    stage.bindings.show(block, {.subdivision = 1}, stage.physics);
    stage.step();
    stage.physics.setGravity({0, -20, 0});
    for (int i = 0; i < 20; ++i) stage.step();
    const auto frame = stage.physics.latest();
    const Vec3 corner = frame->softBody(block)->positions.back(); // where the corner has fallen to
    CHECK(corner.y < ShownStage::mesh()->nodes.back().y - 1e-3);
    CHECK(stage.bindings.paint(block, {.place = corner, .radius = 0.004, .state = kBlood}, stage.physics) == 2);
    CHECK(bloody(*stage.drawn()[0]) == 0); // it appears in the next picture
    stage.step();
    const auto all = stage.drawn();
    CHECK(bloody(*all[0]) == 1);
    CHECK(bloody(*all[1]) > 1); // this one is subdivided
    // The red vertex is the corner.
    const auto red = blood(*all[0]);
    const auto at = static_cast<std::size_t>(std::max_element(red.begin(), red.end()) - red.begin());
    CHECK(red[at] == 255);
    const visual::Float3 expected = visual::toFloat3(ShownStage::mesh()->nodes.back());
    CHECK(all[0]->geometry.rest[at] == expected);
    for (int i = 0; i < 5; ++i) stage.step();
    CHECK(blood(*all[0]) == red);
}

TEST_CASE("a place at rest is in the body's coordinates, before the first step the body is at rest")
{
    ShownStage stage;
    const BodyId block = stage.addBlock({{3, 0, 0}, {}});
    stage.bindings.show(block, {}, stage.physics);
    const Vec3 corner = ShownStage::mesh()->nodes.back();
    const PaintDef mark{.place = corner, .radius = 0.004, .state = kBlood};
    CHECK(stage.bindings.paint(block, mark, stage.physics) == 0); // in world coordinates there is nothing
    PaintDef rest = mark;
    rest.atRest = true;
    CHECK(stage.bindings.paint(block, rest, stage.physics) == 1);
    PaintDef world = mark;
    world.place = corner + Vec3{3, 0, 0};
    CHECK(stage.bindings.paint(block, world, stage.physics) == 1);
    stage.step();
    CHECK(bloody(stage.only()) == 1);
}

TEST_CASE("an instrument is painted on the element that is there")
{
    ShownStage stage;
    const BodyId box = stage.addBox({Pose{}, Pose{{1, 0, 0}, {}}});
    stage.bindings.show(box, {}, stage.physics);
    stage.step();
    CHECK(stage.bindings.paint(box, {.place = {1.01, 0, 0}, .radius = 0.004, .state = kBlood}, stage.physics) > 0);
    stage.step();
    const auto all = stage.drawn();
    CHECK(bloody(*all[0]) == 0);
    CHECK(bloody(*all[1]) > 0);
}

TEST_CASE("paint is there again when the visual server is another one")
{
    ShownStage stage;
    const BodyId block = stage.addBlock();
    stage.bindings.show(block, {}, stage.physics);
    stage.bindings.paint(block, {.place = {0.02, 0, 0}, .radius = 0.02, .state = kBlood}, stage.physics);
    stage.step();
    const auto before = blood(stage.only());
    CHECK(bloody(stage.only()) > 0);
    stage.bindings.release();
    visual::VisualServer next({.backend = visual::Backend::Null});
    stage.bindings.addPending(next);
    stage.bindings.update(*stage.physics.latest(), stage.physics, next);
    REQUIRE(ShownStage::drawn(next).size() == 1);
    CHECK(blood(*ShownStage::drawn(next).front()) == before);
}

TEST_CASE("a reset takes the paint off")
{
    ShownStage stage;
    const BodyId block = stage.addBlock();
    stage.bindings.show(block, {}, stage.physics);
    stage.bindings.paint(block, {.place = {0.02, 0, 0}, .radius = 0.02, .state = kBlood}, stage.physics);
    stage.step();
    CHECK(bloody(stage.only()) > 0);
    stage.bindings.clearPaint();
    stage.step();
    CHECK(bloody(stage.only()) == 0);
}

TEST_CASE("wrong paint is an Error that names the body")
{
    ShownStage stage;
    const BodyId block = stage.addBlock();
    const auto with = [&](const PaintDef& def) { stage.bindings.paint(block, def, stage.physics); };
    CHECK_THROWS_WITH(with({.radius = 0}), "paint soft body 'block': radius must be > 0 m, got 0");
    CHECK_THROWS_WITH(with({.state = {2, 0, 0}}), Catch::Contains("state.blood must be in [0, 1], got 2"));
    CHECK_THROWS_WITH(with({.place = {NAN, 0, 0}}), Catch::Contains("place.x"));
    CHECK_THROWS_AS(stage.bindings.paint({}, {}, stage.physics), Error);
}

TEST_CASE("an observer of contacts marks where a body was touched, from its own thread, through a whole run")
{
    Simulation sim({.physics = {.gravity = {}}});
    const BodyId block =
        sim.add(SoftBodyDef{.name = "block", .mesh = ShownStage::mesh(), .collision = {CollisionDef{}}});
    const BodyId tool = sim.add(RigidBodyDef{.name = "tool",
                                             .elements = {Pose{{0, 0.05, 0}, {}}},
                                             .mesh = shapes::sphere(0.01, 4),
                                             .collision = {CollisionDef{}}});
    sim.show(block);
    std::atomic<int> reached = 0;
    sim.on<ContactEvent>([&](const ContactEvent& contact) {
        if (contact.kind == ContactEvent::Kind::End) return;
        const FrameRef frame = sim.physics().latest();
        for (const auto& each : frame->contacts)
            reached += sim.paint(block, {.place = each.point, .radius = 0.02, .state = kBlood});
    });
    sim.everyStep([&](double time) { sim.physics().setPose(tool, {{0, 0.05 - std::min(0.1 * time, 0.012), 0}, {}}); });
    SECTION("headless") { sim.run({.headless = true, .steps = 150}); }
    SECTION("live") { sim.run({.backend = visual::Backend::Null, .steps = 150, .freeRunning = true}); }
    CHECK(reached > 0);
}

} // namespace paint_test
