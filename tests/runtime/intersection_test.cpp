#include "filasofia/filasofia.h"
#include "filasofia/runtime/intersection_watch.h"

namespace intersection_test {

using namespace filasofia;
using Kind = IntersectionEvent::Kind;
using physics::Intersection;

namespace {

struct Heard {
    Kind kind;
    BodyId first, second;
    double depth;
    friend bool operator==(const Heard&, const Heard&) = default;
};

Intersection pairOf(std::uint32_t first, std::uint32_t second, double depth)
{
    return {.first = BodyId{first}, .second = BodyId{second}, .crossings = 3, .depth = depth};
}

std::vector<Heard> changes(runtime::IntersectionWatch& watch, const std::vector<Intersection>& now)
{
    std::vector<Heard> heard;
    CHECK(watch.observe(now, [&](std::unique_ptr<IntersectionEvent> event) {
        const Intersection& each = event->intersection;
        heard.push_back({event->kind, each.first, each.second, each.depth});
        return true;
    }));
    return heard;
}

} // namespace

TEST_CASE("a pair of bodies begins and ceases to pass through each other once")
{
    runtime::IntersectionWatch watch;
    CHECK(changes(watch, {}).empty());
    CHECK(changes(watch, {pairOf(1, 2, 0.1)}) == std::vector<Heard>{{Kind::Begin, {1}, {2}, 0.1}});
    CHECK(changes(watch, {pairOf(1, 2, 0.2)}).empty());
    CHECK(changes(watch, {pairOf(1, 1, 0.3), pairOf(2, 3, 0.4)}) ==
          std::vector<Heard>{{Kind::End, {1}, {2}, 0.2}, {Kind::Begin, {1}, {1}, 0.3}, {Kind::Begin, {2}, {3}, 0.4}});
    int posted = 0;
    CHECK_FALSE(watch.observe({}, [&](const std::unique_ptr<IntersectionEvent>&) { return ++posted > 1; }));
    CHECK(posted == 2); // the first was lost
    CHECK(changes(watch, {}).empty());
}

TEST_CASE("a tool that is moved into tissue is told by an event, the report and its summary")
{
    Simulation sim({.physics = {.rate = 1000, .gravity = {}}});
    const BodyId organ = sim.add(SoftBodyDef{.name = "organ",
                                             .mesh = shapes::block({40_mm, 40_mm, 40_mm}, {4, 4, 4}),
                                             .attachments = {{.box = Box{{-1, -1, -1}, {1, -19.9_mm, 1}}}},
                                             .collision = {{}}});
    const BodyId tool = sim.add(RigidBodyDef{
        .name = "tool", .elements = {{{0, 60_mm, 0}, {}}}, .mesh = shapes::sphere(5_mm, 6), .collision = {{}}});
    std::vector<IntersectionEvent> heard;
    sim.on<IntersectionEvent>([&](const IntersectionEvent& each) { heard.push_back(each); });
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        if (update.step == 20) sim.physics().setPose(tool, {{0, 21_mm, 0}, {}}); // in one step
        if (update.step == 60) sim.physics().setPose(tool, {{0, 60_mm, 0}, {}});
    });
    const RunReport report = sim.run({.headless = true, .steps = 100});
    REQUIRE(heard.size() == 2);
    CHECK(heard[0].kind == Kind::Begin);
    CHECK(heard[0].intersection.first == organ);
    CHECK(heard[0].intersection.second == tool);
    CHECK(heard[0].step > 20);
    CHECK(heard[0].step <= 32);
    CHECK(heard[1].kind == Kind::End);
    CHECK(heard[1].step > heard[0].step);
    CHECK(report.intersecting > 5);
    CHECK(report.deepestIntersection.depth > 0.1_mm);
    CHECK_THAT(runtime::summary(report),
               Catch::Contains(text("surfaces pass through each other in ", report.intersecting,
                                    " steps: 'organ' and 'tool' through each other by ")) &&
                   Catch::Contains(" mm (one was told to be there, "));
}

} // namespace intersection_test
