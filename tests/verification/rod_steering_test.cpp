#include "verification/rods.h"

namespace rod_steering_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kLength = 0.2;
constexpr int kEdges = 100;

/// The rod's director at its clamp is +y, and direction x director is +z.
void bend(Stage& stage, BodyId rod, const RodSection& section, double rate = std::numeric_limits<double>::infinity())
{
    stage.post(SetCurvature{rod, {section}, rate});
}

/// The largest relative error of the radius of the arc on which the nodes of a section lie, about an axis through
/// `centre`.
double radiusError(const std::vector<Vec3>& x, std::size_t first, std::size_t last, Vec3 centre, double radius)
{
    double worst = 0.0;
    for (std::size_t i = first; i <= last; ++i)
        worst = std::max(worst, std::abs(distance(x[i], centre) / radius - 1.0));
    return worst;
}

double mostAcross(const std::vector<Vec3>& x, Vec3 normal)
{
    double most = 0.0;
    for (Vec3 each : x) most = std::max(most, std::abs(dot(each, normal)));
    return most;
}

} // namespace

TEST_CASE("a section of a rod whose curvature is commanded lies on an arc in the direction that the material says")
{
    // The clamp is one edge long: 2 mm lie before the origin.
    constexpr double l = kLength / kEdges, curvature = 12.0, from = 0.06, to = 0.16;
    constexpr std::size_t first = 31, last = 81; // their nodes
    for (const double angle : {0.0, 0.5 * kPi, kPi, 2.2}) {
        Stage stage;
        const BodyId rod = stage.add(clampedRod(kLength, kEdges));
        bend(stage, rod, {from + l, to + l, {curvature * std::cos(angle), curvature * std::sin(angle)}});
        settle(stage, 0.02, 2000);
        const std::vector<Vec3>& x = stage.soft().x;
        const Vec3 towards{0, std::cos(angle), std::sin(angle)};
        verify(text("rod: commanded curvature of 12 / m towards ", angle,
                    " rad: largest relative error of the arc's radius"),
               radiusError(x, first, last, Vec3{from, 0, 0} + 1.0 / curvature * towards, 1.0 / curvature), 1e-3);
        CHECK(mostAcross(x, cross({1, 0, 0}, towards)) < 1e-9);
        CHECK(dot(x.back(), towards) > 0.0);
        for (std::size_t i = 0; i <= first; ++i) CHECK(length(x[i] - dot(x[i], {1, 0, 0}) * Vec3{1, 0, 0}) < 1e-9);
        // Beyond the section it goes on straight, turned by curvature times length.
        const double turned = curvature * (to - from);
        const Vec3 end = std::cos(turned) * Vec3{1, 0, 0} + std::sin(turned) * towards;
        CHECK(distance(normalized(x.back() - x[last + 1]), end) < 1e-6);
    }
}

TEST_CASE("the tip turns by curvature times length of a section, wherever its borders lie between nodes")
{
    double worst = 0.0;
    for (const double from : {0.0501, 0.0507, 0.0513, 0.0519}) {
        Stage stage;
        const BodyId rod = stage.add(clampedRod(kLength, kEdges));
        bend(stage, rod, {from, from + 0.0433, {20.0, 0.0}});
        settle(stage, 0.02, 2000);
        const std::vector<Vec3>& x = stage.soft().x;
        const Vec3 end = normalized(x.back() - x[x.size() - 2]);
        worst = std::max(worst, std::abs(std::atan2(end.y, end.x) / (20.0 * 0.0433) - 1.0));
    }
    verify("rod: commanded curvature, section between nodes: relative error of the angle of the tip", worst, 1e-6);
}

TEST_CASE("a hand that turns the base of a steered rod turns the plane of its arc with it")
{
    Stage stage;
    const BodyId hand = stage.add(RigidBodyDef{.name = "hand", .elements = {Pose{}}});
    RodBodyDef def = clampedRod(kLength, kEdges);
    def.attachments = {{.nodes = {0, 1}, .to = hand}};
    const BodyId rod = stage.add(def);
    bend(stage, rod, {.begin = 0.102, .curvature = {10.0, 0.0}});
    settle(stage, 0.02, 1000);
    CHECK(stage.soft().x.back().y > 0.03);
    double worst = 0.0;
    for (int i = 1; i <= 300; ++i) {
        stage.post(SetPose{hand, 0, Pose{{}, axisAngle({1, 0, 0}, 0.5 * kPi * i / 300)}});
        stage.step(0.02);
    }
    settle(stage, 0.02, 1000);
    const std::vector<Vec3>& x = stage.soft().x;
    worst = radiusError(x, 51, x.size() - 1, {0.1, 0, 0.1}, 0.1);
    verify("rod: steered tip, base turned by 90 degrees: largest relative error of the arc's radius", worst, 1e-3);
    CHECK(mostAcross(x, {0, 1, 0}) < 1e-4 * kLength);
    CHECK(x.back().z > 0.03);
}

TEST_CASE("a free rod that bends by itself keeps its momentum, and where it yields bending itself leaves no trace")
{
    RodBodyDef def = clampedRod(kLength, kEdges);
    def.attachments.clear();
    def.yieldStrain = 1e-3; // a curvature of 1 / m, far less than what is commanded
    Stage stage;
    const BodyId rod = stage.add(def);
    stage.step(0.0);
    const SoftModel& model = stage.model();
    const auto centre = [&] {
        Vec3 sum;
        double mass = 0.0;
        for (std::size_t i = 0; i < model.masses.size(); ++i) {
            sum += model.masses[i] * stage.soft().x[i];
            mass += model.masses[i];
        }
        return sum / mass;
    };
    const Vec3 before = centre();
    stage.post(SetCurvature{rod, {{0.0, 0.1, {8.0, 3.0}}, {.begin = 0.12, .curvature = {0.0, -10.0}}}, 1.0});
    Vec3 turning;
    double most = 0.0; // the sizes of all parts of the angular momentum
    for (int i = 0; i < 1200; ++i) {
        stage.step(0.01);
        turning = {};
        double size = 0.0;
        for (std::size_t k = 0; k < model.masses.size(); ++k) {
            const Vec3 part = model.masses[k] * cross(stage.soft().x[k] - before, stage.soft().v[k]);
            turning += part;
            size += length(part);
        }
        most = std::max(most, size);
        CHECK(length(turning) < 0.05 * most);
    }
    CHECK(distance(centre(), before) < 1e-12);
    CHECK(stage.soft().rod.steering.back().now == stage.soft().rod.steering.back().target);
    CHECK(distance(stage.soft().x.front(), stage.soft().x.back()) < 0.97 * kLength);
    for (const RodCurvature& each : stage.soft().rod.plastic) CHECK(each == RodCurvature{});
    CHECK(length(turning) < 1e-4 * most);
}

TEST_CASE("the curvature of a steered rod changes at its rate, straight towards where it is commanded")
{
    Stage stage;
    const BodyId rod = stage.add(clampedRod(kLength, kEdges));
    bend(stage, rod, {.curvature = {3.0, 4.0}}, 10.0);
    for (int i = 1; i <= 60; ++i) {
        stage.step(0.01);
        const auto [along, across] = stage.soft().rod.steering[40].now;
        const double exact = std::min(0.1 * i, 5.0);
        REQUIRE(std::abs(along - 0.6 * exact) < 1e-12);
        REQUIRE(std::abs(across - 0.8 * exact) < 1e-12);
    }
    stage.post(SetCurvature{rod, {}, 20.0}); // let go
    stage.run(25, 0.01);
    CHECK(stage.soft().rod.steering[40].now == std::array{0.0, 0.0});
    settle(stage, 0.02, 2000);
    CHECK(distance(stage.soft().x.back(), stage.model().rest.back()) < 1e-6 * kLength);
}

TEST_CASE("a section that begins at the first node of a ring has half of the joint there")
{
    constexpr int nodes = 60;
    RodBodyDef def = clampedRod(kLength, kEdges);
    def.attachments.clear();
    def.closed = true;
    def.spacing = {};
    def.points.clear();
    for (int i = 0; i < nodes; ++i)
        def.points.push_back({0.03 * std::cos(2 * kPi * i / nodes), 0.03 * std::sin(2 * kPi * i / nodes), 0});
    Stage stage;
    const BodyId ring = stage.add(def);
    stage.step(1e-3);
    double whole = 0.0;
    for (const Spring& each : stage.model().rod.edges) whole += each.restLength;
    for (const double part : {0.5, 1.0}) {
        stage.post(SetCurvature{ring, {{0.0, part * whole, {2.0, 0.0}}}});
        stage.step(1e-3);
        double sum = 0.0;
        for (const RodSteering& each : stage.soft().rod.steering) sum += each.target[0] * whole / nodes;
        CHECK_THAT(sum, Catch::WithinRel(2.0 * part * whole, 1e-12));
        CHECK_THAT(stage.soft().rod.steering.back().target[0], Catch::WithinRel(part == 0.5 ? 1.0 : 2.0, 1e-12));
    }
}

} // namespace rod_steering_test
