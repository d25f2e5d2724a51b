#include "filasofia/engine/contact/fragment_solves.h"

#include "engine/rods.h"
#include "engine/stage.h"

namespace fragment_solves_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr Vec3 kGravity{0, -9.81, 0};

void addFragment(Vec3 at, geometry::TetMesh& mesh)
{
    const auto first = static_cast<int>(mesh.nodes.size());
    // What a cut leaves: two flat elements with a common face.
    for (Vec3 corner : {Vec3{}, Vec3{2.1e-3, 0, 0.2e-3}, Vec3{0.3e-3, 0.3e-3, 1.4e-3}, Vec3{0.9e-3, 0.5e-3, 0.4e-3},
                        Vec3{1.6e-3, 0.1e-3, 1.7e-3}})
        mesh.nodes.push_back(at + corner);
    mesh.tetrahedra.push_back({first, first + 2, first + 1, first + 3});
    mesh.tetrahedra.push_back({first + 1, first + 2, first + 4, first + 3});
}

/// A slice of tissue that lies on a table, with fragments beside it.
physics::SoftBodyDef slice(int fragments)
{
    geometry::TetMesh mesh = boxMesh({12, 4, 8}, {0.03, 0.01, 0.02});
    for (Vec3& node : mesh.nodes) node.y += 0.7e-3;
    for (int i = 0; i < fragments; ++i) addFragment({4e-3 * i, 0.7e-3, 0.025}, mesh);
    return {.mesh = shared(std::move(mesh)),
            .material = physics::FemMaterial{.youngModulus = 2e4},
            .collision = {{}},
            .friction = 0.3,
            .dynamicTopology = true};
}

void addTable(Stage& stage)
{
    stage.add(rods::table());
    stage.post(physics::SetGravity{kGravity});
}

int iterationsAtRest(int fragments)
{
    Stage stage;
    stage.add(slice(fragments));
    addTable(stage);
    stage.run(300, 1e-3);
    int sum = 0;
    for (int i = 0; i < 50; ++i) {
        const physics::StepReport report = stage.step(1e-3);
        CHECK(report.flags == 0);
        sum += report.iterations();
    }
    double weight = 0.0, borne = 0.0;
    for (double mass : stage.model().masses) weight += 9.81 * mass;
    for (const frame::Contact& each : stage.world.scene().contactReports) borne += std::abs(each.normalForce);
    CHECK(borne == Approx(weight).epsilon(1e-3));
    return sum;
}

} // namespace

TEST_CASE("small fragments that lie on a table cost their body no iterations")
{
    CHECK(iterationsAtRest(6) <= iterationsAtRest(0) + 50);
}

TEST_CASE("a small fragment that slides beside its body is slowed down by friction")
{
    constexpr double dt = 1e-3, speed = 0.2;
    constexpr int steps = 50;
    Stage stage;
    stage.add(slice(1));
    addTable(stage);
    stage.run(200, dt);
    const std::size_t first = stage.soft().x.size() - 5;
    const SoftState before = stage.soft();
    for (std::size_t i = first; i < before.x.size(); ++i) stage.soft().v[i].x = speed;
    CHECK(stage.run(steps, dt).flags == 0);
    const double slower = 0.3 * 9.81 * dt * dt * steps * (steps + 1) / 2; // m g mu in every step
    for (std::size_t i = first; i < before.x.size(); ++i)
        CHECK(stage.soft().x[i].x - before.x[i].x == Approx(speed * dt * steps - slower).epsilon(0.01));
}

TEST_CASE("a small fragment is pushed by what moves as by what stands still")
{
    // A plate that constraints can move pushes it along, in the solve of its body; one that is told to, apart.
    std::array<double, 2> way{};
    for (const bool dynamic : {false, true}) {
        Stage stage;
        stage.add(slice(1));
        addTable(stage);
        stage.run(100, 1e-3);
        const Vec3 fragment = stage.soft().x.back();
        physics::RigidBodyDef plate{.elements = {Pose{{fragment.x - 4e-3, 1.6e-3, fragment.z}, {}}},
                                    .mesh = geometry::shapes::box({2e-3, 3e-3, 6e-3}),
                                    .dynamic = dynamic,
                                    .collision = {{}}};
        plate.gravity = false;
        const BodyId pushes = stage.add(plate);
        stage.step(1e-3);
        for (int i = 1; i <= 100; ++i) {
            const Vec3 to{fragment.x - 4e-3 + 8e-5 * i, 1.6e-3, fragment.z};
            if (dynamic)
                stage.world.scene().rigid[1].state.velocities[0] = {0.08, 0, 0};
            else
                stage.post(physics::SetPose{pushes, 0, {to, {}}});
            stage.step(1e-3);
        }
        way[dynamic ? 1 : 0] = stage.soft().x.back().x - fragment.x;
    }
    CHECK(way[0] > 3e-3);
    CHECK(way[1] == Approx(way[0]).epsilon(0.1));
}

} // namespace fragment_solves_test
