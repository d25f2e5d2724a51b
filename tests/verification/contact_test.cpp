#include "filasofia/geometry/shapes.h"

#include "verification/hertz.h"

namespace contact_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kG = 9.81;

physics::RigidBodyDef rigidBox(const std::string& name, Vec3 half, Pose pose, double friction = 0.5)
{
    physics::RigidBodyDef def{.name = name, .elements = {pose}, .mesh = geometry::shapes::box(2.0 * half)};
    def.dynamic = true;
    def.friction = friction;
    def.collision = {{}};
    return def;
}

physics::RigidBodyDef floorDef(double friction = 0.5, Quat tilt = {})
{
    physics::RigidBodyDef def = rigidBox("floor", {0.5, 0.05, 0.5}, {rotate(tilt, {0, -0.05, 0}), tilt}, friction);
    def.dynamic = false;
    return def;
}

physics::SoftBodyDef softBlock(std::array<int, 3> cells, Vec3 size, Vec3 corner)
{
    physics::SoftBodyDef def{.mesh = shared(boxMesh(cells, size))};
    def.pose.position = corner;
    def.collision = {{}};
    def.friction = 0.5;
    return def;
}

Vec3 forceOn(const Stage& stage, BodyId body)
{
    return frame::forceOn(body, const_cast<Stage&>(stage).world.scene().contactReports);
}

struct Means {
    Vec3 mean;
    double spread = 0.0; ///< [N] largest distance of a mean over 5 ms from the mean of all
};

/// The force on a body over a time, and the deviation of its means over 5 ms.
Means measureForce(Stage& stage, BodyId body, double seconds, double dt)
{
    std::vector<Vec3> forces;
    for (int i = 0; i < static_cast<int>(std::lround(seconds / dt)); ++i) {
        stage.step(dt);
        forces.push_back(forceOn(stage, body));
    }
    Means all;
    for (Vec3 f : forces) all.mean += 1.0 / static_cast<double>(forces.size()) * f;
    const auto window = static_cast<std::size_t>(std::lround(5e-3 / dt));
    for (std::size_t i = 0; i + window <= forces.size(); i += window) {
        Vec3 mean;
        for (std::size_t k = 0; k < window; ++k) mean += 1.0 / static_cast<double>(window) * forces[i + k];
        all.spread = std::max(all.spread, length(mean - all.mean));
    }
    return all;
}

Stage onFloor(const physics::BodyDef& def, const physics::ContactMethod& method = physics::ExactContact{})
{
    Stage stage({.threads = 1, .contact = method});
    stage.post(physics::SetGravity{{0, -kG, 0}});
    stage.add(floorDef());
    stage.add(def);
    return stage;
}

} // namespace

TEST_CASE("a block at rest presses with its weight, whatever the step and the rounds")
{
    const double weight = 8 * 0.02 * 0.02 * 0.02 * 1000 * kG;
    for (const bool soft : {false, true})
        for (const auto& [dt, rounds] : {std::pair{1e-3, 8}, {5e-4, 8}, {1e-3, 16}}) {
            const physics::BodyDef def =
                soft ? physics::BodyDef(softBlock({4, 4, 4}, {0.04, 0.04, 0.04}, {-0.017, 0.0004, -0.021}))
                     : physics::BodyDef(rigidBox("box", {0.02, 0.02, 0.02}, {{0.003, 0.0204, -0.001}, {}}));
            Stage stage = onFloor(def, physics::ExactContact{.rounds = rounds});
            stage.run(static_cast<int>(1.0 / dt), dt);
            const Means force = measureForce(stage, BodyId{2}, 0.2, dt);
            const std::string name =
                text(soft ? "soft" : "rigid", " block at rest, dt ", dt * 1e3, " ms, ", rounds, " rounds, ");
            verify(name + "mean contact force over its weight, minus one",
                   length(force.mean - Vec3{0, weight, 0}) / weight, 0.01);
            verify(name + "largest deviation of the means over 5 ms, over the weight", force.spread / weight, 0.02);
        }
}

TEST_CASE("a block on a slope slides if the tangent of the slope exceeds the friction, and only then")
{
    for (const double tangent : {0.49, 0.51}) { // mu = 0.5
        const double angle = std::atan(tangent);
        const Quat tilt = axisAngle({0, 0, 1}, -angle);
        Stage stage;
        stage.post(physics::SetGravity{{0, -kG, 0}});
        stage.add(floorDef(0.5, tilt));
        stage.add(rigidBox("box", {0.02, 0.01, 0.02}, {rotate(tilt, {0.003, 0.0101, -0.002}), tilt}));
        stage.run(300, 1e-3);
        const Vec3 before = stage.world.scene().rigid[1].state.poses[0].position;
        const Vec3 speed = stage.world.scene().rigid[1].state.velocities[0];
        stage.run(500, 1e-3);
        const Vec3 after = stage.world.scene().rigid[1].state.poses[0].position;
        const double gained = (length(stage.world.scene().rigid[1].state.velocities[0]) - length(speed)) / 0.5;
        const double expected = std::max(0.0, kG * (std::sin(angle) - 0.5 * std::cos(angle)));
        if (tangent < 0.5)
            verify("block on a slope of tangent 0.49, mu 0.5: moved in 0.5 s [m]", length(after - before), 1e-6);
        else
            verify("block on a slope of tangent 0.51, mu 0.5: acceleration over theory, minus one",
                   std::abs(gained / expected - 1.0), 0.02);
    }
}

TEST_CASE("a tower of five boxes stands")
{
    Stage stage;
    stage.post(physics::SetGravity{{0, -kG, 0}});
    stage.add(floorDef());
    for (int k = 0; k < 5; ++k)
        stage.add(rigidBox(text("box ", k), {0.02, 0.02, 0.02}, {{0, 0.02001 + 0.04001 * k, 0}, {}}));
    stage.run(3000, 1e-3);
    double lean = 0.0;
    for (int k = 0; k < 5; ++k) {
        const Vec3 p = stage.world.scene().rigid[static_cast<std::size_t>(k) + 1].state.poses[0].position;
        lean = std::max(lean, length(p - Vec3{0, 0.02 + 0.04 * k, 0}));
    }
    verify("tower of five boxes after 3 s: largest motion of a box [m]", lean, 1e-4);
    const double weight = 8 * 0.02 * 0.02 * 0.02 * 1000 * kG;
    for (int k = 0; k < 5; ++k) // each bears those above
        CHECK(length(forceOn(stage, BodyId{static_cast<std::uint32_t>(k) + 2}) - Vec3{0, weight, 0}) < 0.01 * weight);
}

// With a penalty derived from the light box's inertia alone, the upper box was thrown off.
TEST_CASE("a box rests on one that weighs a millionth of it, and a light one on a heavy one")
{
    double moved = 0.0, force = 0.0;
    for (const double ratio : {1e-6, 1e-3, 1e2, 1e3, 1e6}) {
        Stage stage;
        stage.post(physics::SetGravity{{0, -kG, 0}});
        stage.add(floorDef());
        const double below = 0.1, above = ratio * below;
        physics::RigidBodyDef light = rigidBox("below", {0.02, 0.02, 0.02}, {{0, 0.0205, 0}, {}});
        physics::RigidBodyDef heavy = rigidBox("above", {0.02, 0.02, 0.02}, {{0.005, 0.061, 0.005}, {}});
        light.mass = physics::TotalMass{below};
        heavy.mass = physics::TotalMass{above};
        stage.add(light);
        const BodyId top = stage.add(heavy);
        stage.run(1000, 1e-3);
        const Scene& scene = stage.world.scene();
        moved = std::max({moved, length(scene.rigid[1].state.poses[0].position - Vec3{0, 0.02, 0}),
                          length(scene.rigid[2].state.poses[0].position - Vec3{0.005, 0.06, 0.005})});
        force =
            std::max(force, length(measureForce(stage, top, 0.1, 1e-3).mean - Vec3{0, above * kG, 0}) / (above * kG));
    }
    verify("a box on one of a millionth to a million times its mass: largest motion of either in 1 s [m]", moved, 1e-4);
    verify("the force on the upper one over its weight, minus one", force, 0.01);
}

// The warm-started impulse grew without bound: 20 kN after half a second, and the stone was shot off at 40 m/s.
TEST_CASE("a stone squeezed by kinematic plates beyond its size feels a bounded force, and is released at rest")
{
    double grown = 0.0, fastest = 0.0;
    for (const double dt : {1e-3, 5e-3})
        for (const double tooClose : {2e-5, 1e-4, 5e-4}) {
            Stage stage;
            physics::RigidBodyDef plate = floorDef();
            plate.mesh = geometry::shapes::box({0.004, 0.03, 0.03});
            std::array<BodyId, 2> plates;
            for (const int i : {0, 1}) {
                plate.elements = {{{i == 0 ? -0.02 : 0.02, 0, 0}, {}}};
                plates[static_cast<std::size_t>(i)] = stage.add(plate);
            }
            physics::RigidBodyDef def{.name = "stone", .elements = {{}}, .mesh = geometry::shapes::sphere(0.006, 6)};
            def.dynamic = true;
            def.gravity = false;
            def.collision = {{}};
            const BodyId stone = stage.add(def);
            double half = 0.02; // [m] from the middle of a plate to the stone's middle
            const auto moveTo = [&](double next, double seconds) {
                const int steps = static_cast<int>(std::lround(seconds / dt));
                for (int i = 0; i < steps; ++i) {
                    half += (next - half) / (steps - i);
                    for (const double side : {-1.0, 1.0})
                        stage.post(physics::SetPose{plates[side < 0.0 ? 0 : 1], 0, {{side * half, 0, 0}, {}}});
                    stage.step(dt);
                }
            };
            const auto squeeze = [&] {
                double sum = 0.0;
                for (const frame::Contact& contact : stage.world.scene().contactReports) sum += contact.normalForce;
                return sum;
            };
            moveTo(0.008 - tooClose, 0.5);
            moveTo(half, 0.05);
            CHECK(squeeze() < 1e7 * tooClose);
            moveTo(half, 0.25);
            const double early = squeeze();
            moveTo(half, 0.5);
            CHECK(early > 0.1);
            grown = std::max(grown, std::abs(squeeze() / early - 1.0));
            for (int i = 0; i < 50; ++i) {
                moveTo(half + 0.01 * dt, dt);
                fastest = std::max(fastest, length(stage.world.scene().rigid[2].state.velocities[0]));
            }
            CHECK(length(forceOn(stage, stone)) < 1e-3);
        }
    verify("a stone squeezed by kinematic plates beyond its size: force after 0.8 s over that after 0.3 s, minus one",
           grown, 0.05);
    verify("the same: its speed when they open [m/s]", fastest, 0.1);
}

TEST_CASE("bodies that touch keep their momentum, whatever their integrators and solvers")
{
    using physics::ConjugateGradient;
    const std::pair<physics::Integrator, physics::Solver> kinds[] = {
        {physics::ImplicitEuler{}, ConjugateGradient{}},
        {physics::ImplicitEuler{}, ConjugateGradient{.assembled = true}},
        {physics::ImplicitEuler{}, physics::Cholesky{}},
        {physics::ExplicitEuler{.symplectic = true}, ConjugateGradient{}}};
    for (const auto& [integrator, solver] : kinds) {
        Stage stage;
        physics::SoftBodyDef a = softBlock({2, 2, 2}, {0.02, 0.02, 0.02}, {0.001, 0.0, 0.0012});
        a.rayleigh = {0.0, 1e-4};
        a.gravity = false;
        a.integrator = integrator;
        a.solver = solver;
        stage.add(a);
        physics::RigidBodyDef b = rigidBox("b", {0.01, 0.01, 0.01}, {{0.0105, 0.034, 0.0095}, {}});
        b.gravity = false;
        b.velocity = {0.0, -0.5, 0.0};
        stage.add(b);
        const double mass = 0.02 * 0.02 * 0.02 * 1000;
        double hit = 0.0;
        for (int i = 0; i < 400; ++i) {
            stage.step(2.5e-4);
            hit = std::max(hit, length(forceOn(stage, BodyId{1})));
        }
        Vec3 momentum = mass * stage.world.scene().rigid[0].state.velocities[0];
        for (std::size_t i = 0; i < stage.soft().v.size(); ++i) momentum += stage.model().masses[i] * stage.soft().v[i];
        CHECK(hit > 0.05);
        verify("momentum lost in a collision, over all", length(momentum - Vec3{0.0, -0.5 * mass, 0.0}) / (0.5 * mass),
               std::holds_alternative<ConjugateGradient>(solver) ? 2e-3 : 1e-6);
    }
}

TEST_CASE("a ball pressed into a soft block feels the force of Hertz")
{
    verifyHertz("ball pressed into a block",
                [](Stage& stage, const geometry::TetMesh& mesh) { stage.add(hertzBlock(mesh)); });
}

TEST_CASE("a soft ball on a floor does not sink in")
{
    Stage stage = onFloor(softBlock({3, 3, 3}, {0.04, 0.04, 0.04}, {-0.02, 0.03, -0.02}));
    double worst = 0.0;
    for (int i = 0; i < 1500; ++i) worst = std::max(worst, stage.step(1e-3).contacts.penetration);
    verify("soft block dropped 3 cm onto a floor: deepest penetration over the sum of proximities", worst / 1e-3, 0.05);
}

TEST_CASE("contacts and friction come out the same for any number of threads")
{
    std::vector<std::uint64_t> hashes;
    for (int threads : {1, 2, 3, 8}) {
        Stage stage({.threads = threads});
        stage.post(physics::SetGravity{{0, -kG, 0}});
        stage.add(floorDef());
        stage.add(softBlock({8, 7, 7}, {0.04, 0.04, 0.04}, {-0.02, 0.0005, -0.02})); // threads share it
        stage.add(softBlock({3, 3, 3}, {0.02, 0.02, 0.02}, {-0.012, 0.0415, -0.011}));
        stage.add(rigidBox("box", {0.01, 0.01, 0.01}, {{0.001, 0.074, 0.002}, axisAngle({1, 0.3, 0.2}, 0.3)}));
        CHECK(stage.run(200, 1e-3).contacts.active > 0);
        CHECK((threads == 1 || threadsShare(stage, threads)));
        hashes.push_back(stage.world.hash());
    }
    for (std::uint64_t hash : hashes) CHECK(hash == hashes.front());
}

} // namespace contact_test
