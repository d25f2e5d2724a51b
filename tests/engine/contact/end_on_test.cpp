#include "filasofia/geometry/shapes.h"

#include "engine/stage.h"

/// What is light for itself, but held by a hand, and pushed with its end against tissue.
namespace end_on_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kLong = 0.03, kAway = 1e-3, kRadius = 0.4e-3, kSpeed = 0.02;

/// A hand over a block of tissue of 40 mm and 20 kPa.
struct Pushed {
    explicit Pushed(double friction)
    {
        physics::SoftBodyDef def{.name = "tissue", .mesh = geometry::shapes::block({0.04, 0.04, 0.04}, {10, 10, 10})};
        def.pose = Pose{{0, -0.02, 0}, {}};
        def.material = physics::FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.45};
        def.rayleigh.mass = 5;
        def.gravity = false;
        def.collision = {{}};
        def.friction = friction;
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.0399, 1}}}};
        stage.add(def);
        hand = stage.add(physics::RigidBodyDef{.name = "hand", .elements = {Pose{top(0.0), {}}}});
    }
    void addWire(double youngModulus, double friction)
    {
        physics::RodBodyDef wire{.name = "wire", .points = {top(0.0), top(kLong)}};
        wire.spacing = 1e-3;
        wire.radius = kRadius;
        wire.youngModulus = youngModulus;
        wire.gravity = false;
        wire.friction = friction;
        wire.collision = physics::RodCollision{};
        wire.attachments = {{.nodes = {0, 1}, .to = hand}};
        stage.add(wire);
    }
    void addTool(double mass)
    {
        physics::RigidBodyDef tool{.name = "tool", .elements = {Pose{top(0.5 * kLong), {}}}};
        tool.mesh = geometry::shapes::capsule(kRadius, kLong - 2 * kRadius, 6);
        tool.dynamic = true;
        tool.gravity = false;
        tool.mass = physics::TotalMass{mass};
        tool.collision = {{}};
        tool.friction = 0.3;
        tool.attachments = {{.to = hand}};
        stage.add(tool);
    }
    /// [m] where a point of the tool is that is so far below the hand
    static Vec3 top(double below) { return {0.003, kLong + kAway - below, 0.002}; }

    /// Pushes by `depth` [m], and waits for 0.1 s.
    void push(double depth, double rate)
    {
        const int steps = static_cast<int>((depth + kAway) / kSpeed * rate), wait = static_cast<int>(0.1 * rate);
        for (int i = 1; i <= steps + wait; ++i) {
            if (i <= steps) stage.post(physics::SetPose{hand, 0, Pose{top(i * kSpeed / rate), {}}});
            flags |= stage.step(1.0 / rate).flags;
            force = 0.0;
            for (const frame::Contact& each : stage.world.scene().contactReports) {
                deepest = std::max(deepest, -each.gap);
                force += each.normalForce;
            }
        }
    }

    Stage stage;
    BodyId hand;
    double deepest = 0.0, force = 0.0; ///< [m], [N]
    std::uint32_t flags = 0;
};

} // namespace

TEST_CASE("a wire that is pushed end-on against tissue stays outside, and bears what a rigid tool bears")
{
    Pushed rigid(0.3);
    rigid.addTool(0.1);
    rigid.push(4e-3, 1000.0);
    for (const auto& [rate, friction] : {std::pair{1000.0, 0.3}, {4000.0, 0.3}, {1000.0, 0.0}}) {
        INFO(rate << " Hz, friction " << friction);
        Pushed wire(friction);
        wire.addWire(2e10, friction);
        wire.push(4e-3, rate);
        CHECK(wire.deepest < 0.1e-3);
        CHECK(wire.flags == 0);
        CHECK(wire.force == Approx(rigid.force).epsilon(0.1));
    }
}

TEST_CASE("a tool of a tenth of a gram that is attached to a hand goes where the hand goes, and bears as much")
{
    Pushed heavy(0.3), light(0.3);
    heavy.addTool(0.1);
    light.addTool(1e-4);
    for (Pushed* each : {&heavy, &light}) each->push(3e-3, 1000.0);
    const Vec3 place = light.stage.world.scene().rigid.back().state.poses[0].position;
    CHECK(length(place - (Pushed::top(0.5 * kLong) - Vec3{0, 3e-3 + kAway, 0})) < 20e-6);
    CHECK(light.deepest < 20e-6);
    CHECK(light.force == Approx(heavy.force).epsilon(0.01));
}

TEST_CASE("a bent wire that straightens in a hollow organ does not pierce its wall, and comes to rest")
{
    for (const auto& [rate, friction] : {std::pair{1000.0, 0.3}, {1000.0, 0.0}, {250.0, 0.3}}) {
        INFO(rate << " Hz, friction " << friction);
        Stage stage;
        physics::SoftBodyDef organ{.name = "organ",
                                   .mesh = geometry::shapes::bladder({0.01, 0.01, 0.01}, 2e-3, {6, 2})};
        organ.material = physics::FemMaterial{.youngModulus = 20e3, .poissonRatio = 0.45};
        organ.rayleigh.mass = 10;
        organ.gravity = false;
        organ.cavities = {{}};
        organ.collision = {{.proximity = 0.3e-3}};
        organ.friction = friction;
        stage.add(organ);
        physics::RodBodyDef wire{.name = "wire", .points = geometry::shapes::arc(6.8e-3, -2.2, 2.2, 39)};
        wire.radius = kRadius;
        wire.youngModulus = 2e8;
        wire.gravity = false;
        wire.friction = friction;
        wire.collision = physics::RodCollision{};
        stage.add(wire);
        double deepest = 0.0;
        std::uint32_t flags = 0;
        for (int i = 0; i < static_cast<int>(0.3 * rate); ++i) {
            flags |= stage.step(1.0 / rate).flags;
            for (const frame::Contact& each : stage.world.scene().contactReports)
                deepest = std::max(deepest, -each.gap);
        }
        CHECK(deepest < kRadius); // by the impact at 1.2 m/s; its axis stays outside
        CHECK(flags == 0);
        double fastest = 0.0, lastDepth = 0.0; // [m/s], [m] depth at the last step
        for (const Vec3& each : stage.soft(1).v) fastest = std::max(fastest, length(each));
        for (const frame::Contact& each : stage.world.scene().contactReports)
            lastDepth = std::max(lastDepth, -each.gap);
        CHECK(fastest < 2e-3);
        CHECK(lastDepth < 5e-6);
    }
}

} // namespace end_on_test
