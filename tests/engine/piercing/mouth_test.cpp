#include "engine/needles.h"

#include <numbers>

/// What happens where a line leaves its channel, and beside it.
namespace mouth_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kDt = 1e-3, kLong = 12e-3;
constexpr double kHalf = 5e-3, kSide = 4e-3; // [m] half of the block, along the channel and across it

/// A thread through a block, drawn out of it in another direction than that in which the needle came out, against a
/// load at its tail. Nothing rubs.
struct Drawn {
    Stage stage;
    Vec3 place{-kHalf - kLong - 3e-3, 0.1e-3, 0.1e-3}; ///< [m] the needle's tail
    BodyId needle, thread;
    std::uint32_t flags = 0;

    explicit Drawn(double edge)
    {
        physics::SoftBodyDef def{.name = "tissue",
                                 .mesh = geometry::shapes::block({2 * kHalf, 2 * kSide, 2 * kSide}, {5, 4, 4})};
        def.material = physics::FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.45};
        def.gravity = false;
        def.collision = {{}};
        def.friction = 0.0;
        def.puncture = physics::PunctureDef{.force = 0.1, .cutting = 0.03, .friction = 0.0};
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.99 * kSide, 1}}}};
        stage.add(def);
        physics::RigidBodyDef tool{.name = "needle",
                                   .elements = {Pose{place, {}}},
                                   .mesh = geometry::shapes::tube({{0, 0, 0}, {kLong, 0, 0}}, 0.3e-3, 8, true)};
        tool.collision = {{}};
        tool.needle = physics::NeedleDef{.line = {{kLong, 0, 0}, {0, 0, 0}}, .radius = 0.3e-3};
        needle = stage.add(tool);
        physics::RodBodyDef rod{.name = "thread", .points = {place, place - Vec3{0.1, 0, 0}}};
        rod.spacing = edge;
        rod.radius = 0.12e-3;
        rod.youngModulus = 0.3e9;
        rod.gravity = false;
        rod.friction = 0.0;
        rod.collision = physics::RodCollision{};
        rod.attachments = {{.nodes = {0}, .to = needle}};
        thread = stage.add(rod);
    }
    template <class Each> void go(Vec3 to, double speed, const Each& each)
    {
        const Vec3 from = place;
        const int steps = static_cast<int>(length(to - from) / speed / kDt);
        for (int i = 1; i <= steps; ++i) {
            place = from + static_cast<double>(i) / steps * (to - from);
            stage.post(physics::SetPose{needle, 0, Pose{place, {}}});
            flags |= static_cast<std::uint32_t>(stage.step(kDt).flags);
            each();
        }
    }
    void go(Vec3 to)
    {
        go(to, 0.05, [] {});
    }
    const SoftBody& rod() { return stage.world.scene().soft.back(); }
    double tension(std::size_t edge) // [N]
    {
        const SoftBody& now = rod();
        const double area = std::numbers::pi * 0.12e-3 * 0.12e-3;
        const double to = length(now.state.x[edge + 1] - now.state.x[edge]);
        return 0.3e9 * area * (to / now.model.rod.edges[edge].restLength - 1.0);
    }
    /// [m] How deep the thread is in the tissue where it is more than 1 mm from its channel, as the tissue was at rest.
    double depth()
    {
        const SoftBody& tissue = stage.world.scene().soft.front();
        const std::vector<Vec3>& x = tissue.state.x;
        double deepest = 0.0;
        for (Vec3 p : rod().state.x)
            for (const auto& each : tissue.model.elements) {
                const Vec3 a = x[each.nodes[1]] - x[each.nodes[0]], b = x[each.nodes[2]] - x[each.nodes[0]],
                           c = x[each.nodes[3]] - x[each.nodes[0]], d = p - x[each.nodes[0]];
                const double volume = dot(a, cross(b, c));
                const std::array w{dot(d, cross(b, c)) / volume, dot(a, cross(d, c)) / volume,
                                   dot(a, cross(b, d)) / volume};
                const double first = 1.0 - w[0] - w[1] - w[2];
                if (std::min({first, w[0], w[1], w[2]}) < 0.0) continue;
                Vec3 rest = first * tissue.model.rest[each.nodes[0]];
                for (std::size_t k = 0; k < 3; ++k) rest += w[k] * tissue.model.rest[each.nodes[k + 1]];
                if (std::hypot(rest.y, rest.z) > 1e-3)
                    deepest = std::max(deepest, std::min({kHalf - std::abs(rest.x), kSide - std::abs(rest.y),
                                                          kSide - std::abs(rest.z)}));
            }
        return deepest;
    }
};

void checkDrawn(double edge, double degrees, double load)
{
    INFO("edges of " << edge << " m, " << degrees << " degrees, " << load << " N");
    Drawn drawn(edge);
    drawn.go({9e-3, 0.1e-3, 0.1e-3});
    const auto last = static_cast<int>(drawn.rod().state.x.size()) - 1;
    drawn.stage.post(physics::SetForces{drawn.thread, {{last, {-load, 0, 0}}}});
    drawn.go({9e-3, 12e-3, 0.1e-3});
    const double angle = degrees * std::numbers::pi / 180.0;
    const Vec3 away{std::cos(angle), std::sin(angle), 0.0};
    drawn.go(Vec3{kHalf, 0.1e-3, 0.1e-3} + 14e-3 * away);
    drawn.go(drawn.place + 6e-3 * away);
    double sum = 0.0;
    int count = 0;
    drawn.go(drawn.place + 8e-3 * away, 0.02, [&] {
        sum += drawn.tension(1);
        ++count;
        if (count % 20 == 0) CHECK(drawn.depth() < 0.1e-3);
    });
    CHECK(drawn.flags == 0);
    CHECK(sum / count == Approx(load).epsilon(0.05));
}

} // namespace

TEST_CASE("a thread that is drawn around the mouth of its channel stays out of the tissue, and slides as it should")
{
    checkDrawn(2e-3, 90.0, 0.4);
    checkDrawn(0.5e-3, 90.0, 0.1);
    checkDrawn(0.5e-3, 135.0, 0.4);
}

TEST_CASE("a thread follows its needle into soft tissue without dragging it along")
{
    // The thread's contacts pushed the tissue at the mouth while the needle's tail was about to go in: with 6 N in
    // place of none, until the thread snapped through.
    Stage stage;
    physics::SoftBodyDef def = tissueBlock(6e-3, {.force = 0.3, .cutting = 0.1, .friction = 10.0});
    def.material = physics::FemMaterial{.youngModulus = 4e4, .poissonRatio = 0.4};
    stage.add(def);
    physics::RigidBodyDef tool = straightNeedle(1e-3);
    const BodyId needle = stage.add(tool);
    const Vec3 tail = tool.elements[0].position + Vec3{0, kToTip, 0};
    physics::RodBodyDef rod{
        .name = "thread", .points = {tail, tail + Vec3{0, 0.1, 0}}, .spacing = 1e-3, .radius = 0.3e-3};
    rod.youngModulus = 2e8;
    rod.gravity = false;
    rod.friction = 0.0;
    rod.collision = physics::RodCollision{.self = false};
    rod.attachments = {{.nodes = {0}, .to = needle}};
    stage.add(rod);
    double pushed = 0.0, contact = 0.0, last = 0.0;
    frame::Frame frame;
    for (int i = 0; i < 1100; ++i) { // down by 55 mm, at 50 mm/s
        stage.post(physics::SetPose{needle, 0, Pose{tool.elements[0].position - Vec3{0, i * 50e-6, 0}, {}}});
        CHECK(stage.step(1e-3).flags == 0);
        stage.world.capture(frame);
        last = 0.0;
        for (const frame::Channel& each : frame.channels) last += length(each.force);
        pushed = std::max(pushed, last);
        if (frame.channels.empty() || i < 700) continue; // the tail comes to the surface after 600
        for (const frame::Contact& each : frame.contacts) contact = std::max(contact, each.normalForce);
    }
    CHECK(last == Approx(10.0 * 6e-3).epsilon(0.02)); // friction alone, along all of the block
    CHECK(pushed < 0.3);
    CHECK(contact < 0.05);
}

TEST_CASE("a needle in its channel is not told as intersecting, but what it carries beside it is")
{
    constexpr double kBeside = 6e-3;
    Stage stage;
    physics::SoftBodyDef def = tissueBlock(4e-3);
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1, 1}}}};
    stage.add(def);
    physics::RigidBodyDef tool = straightNeedle(1e-3);
    tool.elements.push_back(Pose{tool.elements[0].position + Vec3{kBeside, 0.0, 0.0}, {}});
    tool.collision.push_back(
        {.mesh = geometry::shapes::capsule(kNeedleRadius, kNeedleLength), .element = 1, .proximity = 0.3e-3});
    const BodyId needle = stage.add(tool);
    const auto put = [&](double tip, double prong) {
        stage.post(physics::SetPose{needle, 0, Pose{{0.4e-3, tip + kToTip, 0.3e-3}, {}}});
        stage.post(physics::SetPose{needle, 1, Pose{{0.4e-3 + kBeside, prong + kToTip, 0.3e-3}, {}}});
        return stage.step(kNeedleStep);
    };
    for (int i = 0; i <= 600; ++i) CHECK(put(1e-3 - 1e-5 * i, 1e-3).flags == 0);
    REQUIRE(stage.world.scene().channels.size() == 1);
    physics::StepReport report;
    for (int i = 0; i <= 600; ++i) report = put(-5e-3, 1e-3 - 1e-5 * i);
    REQUIRE(report.intersections.size() == 1);
    CHECK(distance(report.intersections.front().place, {0.4e-3 + kBeside, -2e-3, 0.3e-3}) < 3e-3);
}

} // namespace mouth_test
