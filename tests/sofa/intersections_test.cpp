#include "sofa/sofa_stage.h"

#include "filasofia/geometry/shapes.h"

namespace intersections_test {

using namespace filasofia;
using namespace filasofia::physics;
using namespace filasofia::sofa_test;

namespace {

constexpr double kDt = 1e-3;

RigidBodyDef told(const std::string& name, Vec3 place, double size)
{
    RigidBodyDef def{.name = name, .elements = {{place, {}}}, .mesh = geometry::shapes::box({size, size, size})};
    def.collision = {{}};
    return def;
}

SoftBodyDef block()
{
    SoftBodyDef def{.name = "block",
                    .mesh = bar(4, 4, 4, {0.04, 0.04, 0.04}),
                    .pose = {{-0.02, 0, -0.02}, {}},
                    .material = FemMaterial{.youngModulus = 2e4, .law = Corotational{}},
                    .solver = Cholesky{}};
    def.collision = {{}};
    return def;
}

} // namespace

TEST_CASE("surfaces that pass through each other are told, and those that touch are not")
{
    const std::string engine = GENERATE(as<std::string>(), "native", "sofa");
    CAPTURE(engine);
    const auto server = serverWith(engine, kDt);
    server->add(told("floor", {0, -0.05, 0}, 0.1));
    const BodyId soft = server->add(block());
    const BodyId tool = server->add(told("tool", {0, 0.1, 0}, 0.01));
    for (int i = 0; i < 300; ++i) {
        const StepReport report = server->step(kDt);
        REQUIRE_FALSE(report.has(StepFlag::Intersecting));
        REQUIRE(report.intersections.empty());
    }
    const auto jump = [&](Vec3 place) {
        server->setPose(tool, {place, {}});
        return steps(*server, 12, kDt);
    };
    StepReport report = jump({0.001, 0.039, 0.002}); // it sticks in the upper face
    CHECK(report.has(StepFlag::Intersecting));
    REQUIRE(report.intersections.size() == 1);
    CHECK((report.intersections[0].first == soft && report.intersections[0].second == tool));
    CHECK(report.intersections[0].crossings > 0);
    CHECK(report.intersections[0].depth > 1e-3);
    CHECK(report.intersections[0].depth < 0.011);
    CHECK(length(report.intersections[0].place - Vec3{0, 0.04, 0}) < 0.012);
    jump({0, 1, 0});
    REQUIRE_FALSE(jump({0, 1.001, 0}).has(StepFlag::Intersecting));
    report = jump({0.001, 0.02, 0.002}); // wholly inside
    REQUIRE(report.intersections.size() == 1);
    CHECK(report.intersections[0].crossings == 0);
    CHECK(report.intersections[0].depth > 5e-3);
    server->remove(tool);
    CHECK_FALSE(server->step(kDt).has(StepFlag::Intersecting));
}

TEST_CASE("bodies that are tied may pass through each other")
{
    const auto server = serverWith("sofa", kDt, {});
    const BodyId soft = server->add(block()), tool = server->add(told("tool", {0.001, 0.038, 0.002}, 0.01));
    CHECK(steps(*server, 2, kDt).has(StepFlag::Intersecting));
    server->attach(soft, AttachmentDef{.within = 0.005, .to = tool});
    CHECK_FALSE(steps(*server, 12, kDt).has(StepFlag::Intersecting));
}

} // namespace intersections_test
