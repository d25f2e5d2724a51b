#include "filasofia/geometry/shapes.h"
#include "filasofia/testing/linking.h"

#include "verification/rods.h"

#include <optional>

/// Threads do not pass through threads and bars, and what holds them is right in steps that are solved again.
namespace rod_passing_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// How far the second of two crossing threads is above the first, where they cross as seen from above; nothing if they
/// do not.
std::optional<double> heightAtCrossing(const std::vector<Vec3>& first, const std::vector<Vec3>& second)
{
    for (std::size_t i = 0; i + 1 < first.size(); ++i)
        for (std::size_t k = 0; k + 1 < second.size(); ++k) {
            const Vec3 a = first[i], u = first[i + 1] - a, b = second[k], v = second[k + 1] - b, r = b - a;
            const double area = u.x * v.z - u.z * v.x;
            if (area == 0.0) continue;
            const double s = (r.x * v.z - r.z * v.x) / area, t = (r.x * u.z - r.z * u.x) / area;
            if (s < 0.0 || s > 1.0 || t < 0.0 || t > 1.0) continue;
            return r.y + t * v.y - s * u.y;
        }
    return std::nullopt;
}

} // namespace

TEST_CASE("a thread that is thrown at a thread does not pass through it")
{
    for (const double speed : {0.1, 0.5, 1.0, 2.0})
        for (const double offset : {0.0, 0.37e-3}) { // where along an edge they meet
            RodBodyDef held{.name = "held", .spacing = 1e-3, .radius = 0.15e-3, .collision = RodCollision{}};
            RodBodyDef thrown = held;
            thrown.name = "thrown";
            held.points = {{-0.03, 0, 0}, {0.03, 0, 0}};
            held.attachments = {{.nodes = {0, 1, 59, 60}}};
            thrown.points = {{offset, 0.003, -0.03}, {offset + 0.002, 0.003, 0.03}};
            Stage stage;
            stage.world.scene().gravity = {};
            stage.add(held);
            stage.add(thrown);
            stage.step(0.0);
            for (Vec3& v : stage.soft(1).v) v = {0, -speed, 0};
            double nearest = 1.0;
            for (int i = 0; i < 150; ++i) {
                const StepReport report = stage.step(1e-3);
                CHECK((report.flags & ~static_cast<std::uint32_t>(StepFlag::Restless)) == 0);
                if (const auto height = heightAtCrossing(stage.soft(0).x, stage.soft(1).x))
                    nearest = std::min(nearest, *height);
            }
            verifyWithin(
                text("rod: thrown at a rod with ", speed, " m/s: least distance of their lines over the diameter"),
                nearest / 0.3e-3, 0.9, 1.1);
        }
}

TEST_CASE("springs that hold threads draw with the force of their length, also in steps that are solved again")
{
    // A force that begins at once moves the upper thread by many diameters in a step, so it would pass through the
    // lower one, and the step is solved again.
    constexpr double stiffness = 300.0;
    RodBodyDef lower{.spacing = 1e-3, .radius = 0.15e-3, .youngModulus = 1e7, .collision = RodCollision{}};
    RodBodyDef upper = lower;
    lower.points = {{-0.02, 0, 0}, {0.02, 0, 0}};
    upper.points = {{0, 2e-3, -0.02}, {0, 2e-3, 0.02}};
    upper.forces = {{.node = 20, .force = {0, -0.1, 0}}};
    Stage stage;
    stage.world.scene().gravity = {};
    for (RodBodyDef* def : {&lower, &upper})
        for (const std::size_t end : {0, 1})
            def->attachments.push_back({.nodes = {end == 0 ? 0 : 40},
                                        .stiffness = stiffness,
                                        .to = stage.add(RigidBodyDef{.elements = {Pose{def->points[end]}}})});
    for (const RodBodyDef* def : {&lower, &upper}) stage.add(*def);
    double worst = 0.0, most = 0.0;
    frame::Frame frame;
    for (int i = 0; i < 20; ++i) {
        stage.step(1e-3);
        stage.world.capture(frame);
        REQUIRE(frame.attachments.size() == 4);
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3 place = (k < 2 ? lower : upper).points[k % 2], end = stage.soft(k / 2).x[k % 2 == 0 ? 0 : 40];
            worst = std::max(worst, length(frame.attachments[k].force - stiffness * (place - end)));
            most = std::max(most, length(frame.attachments[k].force));
        }
    }
    CHECK(heightAtCrossing(stage.soft(0).x, stage.soft(1).x) > 0.0);
    verify("rod: springs of threads that would pass: error of their force, relative to the largest", worst / most,
           1e-6);
}

TEST_CASE("a thin bar that is drawn at a taut thread takes it along, and does not come through")
{
    constexpr double radius = 0.12e-3, speed = 0.3, dt = 1e-3;
    RodBodyDef def{.points = {{-0.012, 1.0e-3, 0}, {0.012, 1.0e-3, 0}}, .spacing = 4.0 * radius, .radius = radius};
    def.youngModulus = 0.6e9;
    def.collision = RodCollision{.proximity = 0.4 * radius};
    Stage stage;
    stage.world.scene().gravity = {};
    for (const std::size_t end : {0, 1})
        def.attachments.push_back({.nodes = {end == 0 ? 0 : 50},
                                   .stiffness = 500.0,
                                   .to = stage.add(RigidBodyDef{.elements = {Pose{def.points[end]}}})});
    stage.add(def);
    RigidBodyDef bar{.elements = {Pose{}}, .collision = {{.proximity = 0.5 * radius}}};
    bar.mesh = geometry::shapes::tube({{0, 0, -0.012}, {0, 0, 0.012}}, 3.0 * radius, 12);
    const BodyId tool = stage.add(bar);
    stage.step(0.0);
    REQUIRE(stage.soft().x.size() == 51);
    double deepest = 0.0;
    int passes = 0;
    testing::PassCounter counter;
    std::vector<Vec3> axis{{0, 0, -0.012}, {0, 0, 0.012}};
    for (int i = 1; i <= 40; ++i) {
        const std::vector<Vec3> before = stage.soft().x, axisBefore = axis;
        for (Vec3& p : axis) p.y += speed * dt;
        stage.post(SetPose{tool, 0, Pose{{0, axis[0].y, 0}}});
        const StepReport report = stage.step(dt);
        deepest = std::max(deepest, report.contacts.penetration);
        passes += std::abs(counter.count({before, stage.soft().x}, {axisBefore, axis}));
    }
    CHECK(passes == 0);
    verify("rod: a bar drawn at a thread at 0.3 m/s: how deep it is in it, in diameters", deepest / (2.0 * radius),
           0.6);
}

TEST_CASE("a thread that stops dead takes along what follows it: detection saw them move as one")
{
    // Both move upwards with 1.5 m/s, so nothing closes, until the hands that hold the thread stop within a step.
    constexpr double radius = 0.3e-3, thin = 0.2e-3, speed = 1.5, dt = 1e-3, gap = 0.4e-3;
    constexpr double above = thin + radius + gap;
    RodBodyDef def{.points = {{-0.006, above, 0}, {0.006, above, 0}}, .spacing = 1e-3, .radius = radius};
    def.youngModulus = 5e9;
    def.collision = RodCollision{.proximity = 0.1e-3};
    Stage stage;
    stage.world.scene().gravity = {};
    std::array<BodyId, 2> hands;
    for (const std::size_t end : {0, 1}) {
        hands[end] = stage.add(RigidBodyDef{.elements = {Pose{def.points[end]}}});
        const int first = end == 0 ? 0 : 11;
        def.attachments.push_back({.nodes = {first, first + 1}, .to = hands[end]});
    }
    stage.add(def);
    RigidBodyDef bar{.elements = {Pose{}}, .collision = {{.proximity = 0.1e-3}}};
    bar.mesh = geometry::shapes::tube({{0, 0, -0.012}, {0, 0, 0.012}}, thin, 12);
    const BodyId tool = stage.add(bar);
    stage.step(0.0);
    REQUIRE(stage.soft().x.size() == 13);
    int passes = 0;
    testing::PassCounter counter;
    std::vector<Vec3> axis{{0, 0, -0.012}, {0, 0, 0.012}};
    for (int i = 1; i <= 40; ++i) {
        const std::vector<Vec3> before = stage.soft().x, axisBefore = axis;
        const double stops = 20 * speed * dt;
        const double hand = std::min(i * speed * dt, stops), follows = std::min(i * speed * dt, stops + speed * dt);
        for (Vec3& p : axis) p.y = follows;
        stage.post(SetPose{tool, 0, Pose{{0, follows, 0}}});
        for (std::size_t end : {0, 1}) stage.post(SetPose{hands[end], 0, Pose{def.points[end] + Vec3{0, hand, 0}}});
        stage.step(dt);
        passes += std::abs(counter.count({before, stage.soft().x}, {axisBefore, axis}));
    }
    CHECK(passes == 0);
    // It lies on the bar, which has come farther than the hands by a step.
    verifyWithin("rod: stopped in front of a bar: height over the bar, over both radii",
                 (stage.soft().x[6].y - axis[0].y) / (thin + radius), 0.7, 1.2);
}

} // namespace rod_passing_test
