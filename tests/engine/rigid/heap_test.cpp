#include "engine/rigid/rigid_bodies.h"

#include "filasofia/geometry/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace heap_test {

using namespace filasofia;
using namespace filasofia::engine;
using physics::StepFlag;

namespace {

/// A wall, a floor.
physics::RigidBodyDef fixedBox(Vec3 size, Vec3 at, double friction)
{
    return {.elements = {{at, {}}}, .mesh = geometry::shapes::box(size), .collision = {{}}, .friction = friction};
}

/// Balls of 5 mm and 0.5 g that fall one after another into a bin in which one has room beside another. Their facets
/// are shorter than the distance at which contacts are looked for, so that dozens of contacts are between two of them.
struct Bin {
    Stage stage{{.period = 1e-3, .threads = 1}};
    std::vector<BodyId> balls;

    Bin(int count, double friction, unsigned seed)
    {
        stage.world.scene().gravity = {0, -9.81, 0};
        stage.add(fixedBox({0.6, 0.02, 0.6}, {0, -0.01, 0}, friction));
        for (const double side : {-0.022, 0.022}) {
            stage.add(fixedBox({0.02, 0.4, 0.2}, {side, 0.2, 0}, friction));
            stage.add(fixedBox({0.2, 0.4, 0.02}, {0, 0.2, side}, friction));
        }
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> aside(-0.005, 0.005);
        for (int i = 0; i < count; ++i) {
            const double x = aside(random), z = aside(random);
            balls.push_back(stage.add(physics::RigidBodyDef{.elements = {{{x, 0.007 + 0.0105 * i, z}, {}}},
                                                            .mesh = geometry::shapes::sphere(0.005, 8),
                                                            .dynamic = true,
                                                            .mass = physics::Density{1000.0},
                                                            .collision = {{}},
                                                            .friction = friction}));
        }
        stage.step(0.0);
    }
    /// [m^2/s^2] Kinetic energy without spin and height, over the mass of a ball.
    double energy()
    {
        double sum = 0.0;
        for (const RigidBody& body : stage.world.scene().rigid)
            if (body.model.dynamic)
                sum += 0.5 * lengthSquared(body.state.velocities[0]) + 9.81 * body.state.poses[0].position.y;
        return sum;
    }
    double fastest() // [m/s]
    {
        double most = 0.0;
        for (const RigidBody& body : stage.world.scene().rigid) most = std::max(most, length(body.state.velocities[0]));
        return most;
    }
};

/// 36 boxes of 20 x 30 x 25 mm that fall into a bin, turned in any way.
struct Boxes {
    Stage stage{{.period = 1e-3, .threads = 1}};

    explicit Boxes(double friction)
    {
        stage.world.scene().gravity = {0, -9.81, 0};
        stage.add(fixedBox({0.6, 0.02, 0.6}, {0, -0.01, 0}, friction));
        for (const double side : {-0.09, 0.09}) {
            stage.add(fixedBox({0.02, 0.4, 0.2}, {side, 0.2, 0}, friction));
            stage.add(fixedBox({0.2, 0.4, 0.02}, {0, 0.2, side}, friction));
        }
        std::mt19937 random(3);
        std::normal_distribution<double> any;
        for (int i = 0; i < 36; ++i) {
            const double w = any(random), x = any(random), y = any(random), z = any(random);
            const Vec3 at{0.042 * (i % 9 / 3 - 1), 0.03 + 0.042 * (i / 9), 0.042 * (i % 3 - 1)};
            stage.add(physics::RigidBodyDef{.elements = {{at, normalized(Quat{w, x, y, z})}},
                                            .mesh = geometry::shapes::box({0.02, 0.03, 0.025}),
                                            .dynamic = true,
                                            .mass = physics::Density{1000.0},
                                            .collision = {{}},
                                            .friction = friction});
        }
    }
};

/// A tetrahedron of 12 mm along the axes, or a spike of 24 mm on a base of six corners.
std::shared_ptr<const geometry::TriangleMesh> sharpSurface(bool spike)
{
    constexpr double kLong = 0.012, kThin = 0.0012;
    geometry::TriangleMesh mesh;
    if (!spike) {
        mesh.vertices = {{0, 0, 0}, {kLong, 0, 0}, {0, kLong, 0}, {0, 0, kLong}};
        mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
        return std::make_shared<const geometry::TriangleMesh>(std::move(mesh));
    }
    for (int i = 0; i < 6; ++i)
        mesh.vertices.push_back(
            {kThin * std::cos(i * std::numbers::pi / 3), 0, kThin * std::sin(i * std::numbers::pi / 3)});
    mesh.vertices.push_back({0, kLong, 0});
    mesh.vertices.push_back({0, -kLong, 0});
    for (int i = 0; i < 6; ++i) {
        mesh.triangles.push_back({(i + 1) % 6, i, 6});
        mesh.triangles.push_back({i, (i + 1) % 6, 7});
    }
    return std::make_shared<const geometry::TriangleMesh>(std::move(mesh));
}

/// Sixteen sharp bodies, turned in any way, that fall on a floor one after another; the last one is heavy.
struct Shards {
    Stage stage{{.period = 1e-3, .threads = 1}};

    explicit Shards(unsigned seed)
    {
        stage.world.scene().gravity = {0, -9.81, 0};
        stage.add(fixedBox({3.0, 0.02, 3.0}, {0, -0.01, 0}, 0.4));
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> part(-1.0, 1.0);
        for (int i = 0; i < 16; ++i) {
            const Vec3 at{0.008 * part(random), 0.012 + 0.014 * i, 0.008 * part(random)};
            const Quat turned = normalized(Quat{part(random), part(random), part(random), part(random)});
            stage.add(physics::RigidBodyDef{.elements = {{at, turned}},
                                            .mesh = sharpSurface(i % 2 == 1),
                                            .dynamic = true,
                                            .mass = physics::Density{i == 15 ? 20000.0 : 1000.0},
                                            .collision = {{}},
                                            .friction = 0.4});
        }
    }
};

} // namespace

TEST_CASE("sharp bodies whose edges cross in a heap part again")
{
    for (unsigned seed = 1; seed <= 6; ++seed) {
        CAPTURE(seed);
        Shards shards(seed);
        int crossing = 0, atLast = 0;
        double fastest = 0.0;
        for (int i = 0; i < 1500; ++i) {
            const bool crosses = shards.stage.step(1e-3).has(StepFlag::Intersecting);
            crossing += crosses ? 1 : 0;
            atLast += crosses && i >= 1000 ? 1 : 0;
            for (const RigidBody& body : shards.stage.world.scene().rigid)
                if (body.model.dynamic) fastest = std::max(fastest, length(body.state.velocities[0]));
        }
        CHECK(crossing < 50); // without parting 177, 72 and 76 in three of the seeds
        CHECK(atLast == 0);
        CHECK(fastest < 3.0); // it falls at 2.1 m/s
    }
}

TEST_CASE("free rigid bodies that start through each other come apart calmly")
{
    // Before, the cubes pressed with 141 kN and stayed, as did the bars, without any force.
    struct Start {
        Vec3 one, two, at;
    };
    for (const Start& start : {Start{{0.04, 0.004, 0.004}, {0.004, 0.004, 0.04}, {0.001, 0.002, 0.0007}},
                               Start{{0.04, 0.04, 0.04}, {0.04, 0.04, 0.04}, {0.03, 0.003, 0.004}}}) {
        Stage stage{{.period = 1e-3, .threads = 1}};
        for (const bool second : {false, true})
            stage.add(physics::RigidBodyDef{.elements = {{second ? start.at : Vec3{}, {}}},
                                            .mesh = geometry::shapes::box(second ? start.two : start.one),
                                            .dynamic = true,
                                            .mass = physics::Density{1000.0},
                                            .gravity = false,
                                            .collision = {{}},
                                            .friction = 0.3});
        double strongest = 0.0, fastest = 0.0;
        bool crosses = true;
        for (int i = 0; i < 600; ++i) {
            crosses = stage.step(1e-3).has(StepFlag::Intersecting);
            for (const frame::Contact& each : stage.world.scene().contactReports)
                strongest = std::max(strongest, each.normalForce);
            for (const RigidBody& body : stage.world.scene().rigid)
                fastest = std::max(fastest, length(body.state.velocities[0]));
        }
        CHECK_FALSE(crosses);
        CHECK(strongest < 10.0);
        CHECK(fastest < 0.2);
    }
}

TEST_CASE("a heap of small round bodies gains no energy, and comes to rest")
{
    // Solves that ended with a linearised law handed on the impulses that this law asks for, not those that acted: 45
    // times the energy at the start, and 10 m/s.
    for (const double friction : {0.0, 0.3}) {
        Bin bin(6, friction, 1);
        double highest = 0.0;
        int unlawful = 0;
        const double atStart = bin.energy();
        for (int i = 0; i < 1000; ++i) {
            const physics::StepReport report = bin.stage.step(1e-3);
            highest = std::max(highest, bin.energy() / atStart);
            CHECK_FALSE(report.has(StepFlag::Undone));
            // Forces that are not those of the contact law are told.
            unlawful += report.contacts.mismatch > 0.05 && !report.has(StepFlag::NotConverged) ? 1 : 0;
        }
        CAPTURE(friction);
        CHECK(highest < 1.001);
        CHECK(bin.fastest() < 1e-3);
        CHECK(unlawful == 0);
    }
}

TEST_CASE("boxes that fall on each other and tip do not pass through each other")
{
    // A box that fell on one edge had its only contact there, and its next edge was deep in the other box one step
    // later: 9.9 mm in the end.
    Boxes boxes(0.0);
    CHECK_FALSE(boxes.stage.run(300, 1e-3).has(StepFlag::Intersecting));
}

TEST_CASE("friction in a heap that falls together is solved")
{
    // Newton's method alone left 60 of these steps unsolved, with impulses up to 4,000 times the largest from their
    // law.
    Boxes boxes(0.3);
    int unsolved = 0;
    double worst = 0.0;
    for (int i = 0; i < 400; ++i) {
        const physics::StepReport report = boxes.stage.step(1e-3);
        unsolved += report.has(StepFlag::NotConverged) ? 1 : 0;
        worst = std::max(worst, report.contacts.mismatch);
        CHECK_FALSE(report.has(StepFlag::Intersecting));
    }
    CAPTURE(unsolved);
    CAPTURE(worst);
    CHECK(unsolved <= 8);
    CHECK(worst < 0.02);
}

} // namespace heap_test
