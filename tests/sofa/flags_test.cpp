#include "sofa/sofa_stage.h"

/// What a step tells of elements and of the motion of bodies, on both engines.
namespace flags_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

SoftBodyDef block()
{
    return {.name = "block",
            .mesh = bar(2, 2, 2, {0.02, 0.02, 0.02}),
            .material = FemMaterial{.youngModulus = 5e3, .poissonRatio = 0.3, .law = Corotational{}},
            .rayleigh = {.mass = 5.0, .stiffness = 1e-3},
            .solver = Cholesky{}};
}

} // namespace

TEST_CASE("elements that are inside out are told")
{
    const std::string engine = GENERATE("native", "sofa");
    const auto server = serverWith(engine, 1e-3, {});
    SoftBodyDef def = block();
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}};
    const BodyId body = server->add(def);
    const BodyId hand = server->add(RigidBodyDef{.name = "hand"});
    server->attach(body, {.box = geometry::Box{{0.0199, -1, -1}, {1, 1, 1}}, .to = hand});
    int steps = 0;
    StepReport report;
    for (; steps < 400 && !report.has(StepFlag::Inverted); ++steps) {
        server->setPose(hand, {{-1e-4 * steps, 0, 0}, {}});
        report = server->step(1e-3);
    }
    REQUIRE(report.has(StepFlag::Inverted));
    CHECK(report.inverted.count > 0);
    CHECK(report.inverted.body == body);
    CHECK(report.inverted.volume <= 0.0);
    CHECK(steps > 100);
    CHECK(steps < 300);
}

TEST_CASE("strain beyond what a material is valid for is told")
{
    const std::string engine = GENERATE("native", "sofa");
    const auto server = serverWith(engine, 1e-3, {});
    SoftBodyDef def = block();
    std::get<FemMaterial>(def.material).validStrain = 0.2;
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}};
    const BodyId body = server->add(def);
    const BodyId hand = server->add(RigidBodyDef{.name = "hand"});
    server->attach(body, {.box = geometry::Box{{0.0199, -1, -1}, {1, 1, 1}}, .to = hand});
    StepReport report;
    for (int i = 0; i < 30; ++i) {
        server->setPose(hand, {{1e-4 * i, 0, 0}, {}});
        report = server->step(1e-3);
    }
    CHECK_FALSE(report.has(StepFlag::BeyondStrain)); // 15 %, or little more in a corner
    for (int i = 30; i < 120; ++i) {
        server->setPose(hand, {{1e-4 * i, 0, 0}, {}});
        report = server->step(1e-3);
    }
    REQUIRE(report.has(StepFlag::BeyondStrain));
    CHECK(report.beyondStrain.body == body);
    CHECK(report.beyondStrain.valid == 0.2);
    CHECK(report.beyondStrain.strain > 0.4);
}

TEST_CASE("a body that goes on moving though nothing drives it is told", "[slow]")
{
    const std::string engine = GENERATE("native", "sofa");
    const auto server = serverWith(engine, 1e-2, {});
    SoftBodyDef def = block();
    def.rayleigh = {};
    server->add(def);
    RigidBodyDef top{.name = "top", .dynamic = true, .mass = GivenInertia{}};
    top.angularVelocity = {0, 3, 0};
    const BodyId spinning = server->add(top);
    StepReport report;
    int steps = 0;
    for (; steps < 700 && !report.has(StepFlag::Restless); ++steps) report = server->step(1e-2);
    REQUIRE(report.has(StepFlag::Restless));
    CHECK(report.unrest.body == spinning);
    CHECK(report.unrest.bodies == 1); // the block rests
    CHECK(steps == Approx(500).margin(101));
    const auto saved = server->save();
    server->setGravity({0, 1e-9, 0}); // something has driven the scene
    CHECK_FALSE(server->step(1e-2).has(StepFlag::Restless));
    server->restore(*saved); // a saved state knows that nothing had
    CHECK(server->step(1e-2).has(StepFlag::Restless));
}

} // namespace flags_test
