#include "filasofia/engine/topology/loose_pieces.h"

#include "engine/stage.h"

#include "filasofia/geometry/shapes.h"

namespace loose_pieces_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// A block of 4 cm, pinned at the bottom, and beside it a fragment of one tetrahedron of half a millimetre: 1e-5 of its
/// mass.
physics::SoftBodyDef blockAndFragment()
{
    geometry::TetMesh mesh = boxMesh({6, 6, 6}, {0.04, 0.04, 0.04});
    const auto first = static_cast<int>(mesh.nodes.size());
    for (Vec3 corner : {Vec3{}, Vec3{5e-4, 0, 0}, Vec3{0, 5e-4, 0}, Vec3{0, 0, 5e-4}})
        mesh.nodes.push_back(Vec3{0.06, 0, 0} + corner);
    mesh.tetrahedra.push_back({first, first + 1, first + 2, first + 3});
    return {.mesh = shared(std::move(mesh)),
            .material = physics::FemMaterial{.youngModulus = 5e3},
            .rayleigh = {.mass = 0.0, .stiffness = 2e-3},
            .attachments = {{.box = geometry::Box{{-1, -1, -1}, {0.05, 1, 1e-6}}}},
            .dynamicTopology = true};
}

/// The fragment alone.
physics::SoftBodyDef fragmentAlone()
{
    physics::SoftBodyDef def = blockAndFragment();
    const geometry::TetMesh& both = *std::get<std::shared_ptr<const geometry::TetMesh>>(def.mesh);
    def.mesh = shared(geometry::TetMesh{{both.nodes.end() - 4, both.nodes.end()}, {{0, 1, 2, 3}}});
    def.attachments.clear();
    def.solver = physics::Cholesky{};
    return def;
}

struct Momenta {
    Vec3 linear, angular; ///< [kg m/s], [kg m^2/s] about the origin
};
Momenta momentaOf(const std::vector<int>& nodes, const SoftModel& model, const SoftState& state)
{
    Momenta sum;
    for (int node : nodes) {
        const auto i = static_cast<std::size_t>(node);
        const Vec3 momentum = model.masses[i] * state.v[i];
        sum.linear += momentum;
        sum.angular += cross(state.x[i], momentum);
    }
    return sum;
}

/// Makes the fragment spin about an axis through its first corner and fly.
void spin(Stage& stage, const BodyPiece& fragment, Vec3 turn)
{
    for (int node : fragment.nodes) {
        const auto i = static_cast<std::size_t>(node);
        stage.soft().v[i] =
            Vec3{0.3, 0, 0} +
            cross(turn, stage.soft().x[i] - stage.soft().x[static_cast<std::size_t>(fragment.nodes[0])]);
    }
}

/// A fragment beside its block and one alone start to fall with equal spin. Returns the first node of the former.
std::size_t startTogether(Stage& together, Stage& alone)
{
    for (Stage* stage : {&together, &alone}) {
        stage->post(physics::SetGravity{{0, 0, -9.81}});
        stage->step(0.0);
    }
    spin(together, together.model().pieces[1], {100.0, 50.0, -20.0});
    const std::size_t first = together.soft().x.size() - 4;
    for (std::size_t i = 0; i < 4; ++i) alone.soft().v[i] = together.soft().v[first + i];
    return first;
}

} // namespace

TEST_CASE("a loose piece that spins too fast is slowed to the limit and conserves its linear momentum")
{
    Stage stage;
    stage.add(blockAndFragment());
    stage.step(0.0);
    const SoftModel& model = stage.model();
    REQUIRE(model.pieces.size() == 2);
    const BodyPiece& fragment = model.pieces[1];
    REQUIRE(fragment.nodes.size() == 4);

    constexpr double dt = 1e-3, maxTurn = 0.25;
    spin(stage, fragment, {100.0, 0, 150.0}); // 0.18 rad per step
    const SoftState slow = stage.soft();
    limitSpin(model, maxTurn, dt, stage.soft());
    CHECK(stage.soft().v == slow.v);

    spin(stage, fragment, {1000.0, 0, 1500.0});
    const Momenta before = momentaOf(fragment.nodes, model, stage.soft());
    limitSpin(model, maxTurn, dt, stage.soft());
    const Momenta after = momentaOf(fragment.nodes, model, stage.soft());
    CHECK(length(after.linear - before.linear) < 1e-12 * length(before.linear));
    CHECK(length(after.angular - before.angular) > 1e-3 * length(before.angular));
    SoftState again = stage.soft(); // at the limit now, about the same axis
    limitSpin(model, (1.0 + 1e-9) * maxTurn, dt, again);
    CHECK(again.v == stage.soft().v);
    limitSpin(model, (1.0 - 1e-6) * maxTurn, dt, again);
    CHECK(again.v != stage.soft().v);
}

TEST_CASE("a fragment that was torn off spinning gains no speed, however light it is beside the rest")
{
    Stage stage;
    stage.add(blockAndFragment());
    stage.post(physics::SetGravity{{0, 0, -9.81}});
    stage.step(0.0);
    spin(stage, stage.model().pieces[1], {2e3, 3e3, -1e3}); // 4 rad per step
    CHECK(stage.run(1000, 1e-3).flags == 0);
    const std::size_t n = stage.soft().x.size();
    for (std::size_t i = n - 4; i < n; ++i) {
        CHECK(length(stage.soft().v[i] - stage.soft().v[n - 4]) < 2.0);
        CHECK(length(stage.soft().x[i] - stage.soft().x[n - 4]) < 2e-3);
    }
    CHECK(stage.soft().v[n - 1].z == Approx(-9.81).margin(0.5)); // it falls correctly
}

TEST_CASE("a fragment moves beside the rest of its body as it does alone with an exact solve")
{
    Stage together, alone;
    together.add(blockAndFragment());
    alone.add(fragmentAlone());
    const std::size_t first = startTogether(together, alone);
    together.run(200, 1e-3);
    alone.run(200, 1e-3);
    for (std::size_t i = 0; i < 4; ++i) CHECK(distance(together.soft().x[first + i], alone.soft().x[i]) < 1e-5);
}

TEST_CASE("if a free body and its fragment leave the scene, the fragment is removed and the body stays")
{
    physics::SoftBodyDef def = blockAndFragment();
    def.attachments.clear();
    Stage stage;
    stage.add(def);
    stage.step(0.0);
    REQUIRE(stage.model().pieces.size() == 2);
    for (Vec3& x : stage.soft().x) x.y -= 20.0;
    CHECK(stage.step(1e-3).topology.lost == 1);
    CHECK(stage.model().removed == std::set<int>{1});
    CHECK(stage.step(1e-3).topology.lost == 0);
}

TEST_CASE("a fragment moves as it does alone, even if the solve of the whole body is cut short")
{
    Stage together, alone;
    physics::SoftBodyDef def = blockAndFragment();
    def.solver = physics::ConjugateGradient{.maxIterations = 1, .tolerance = 1e-6};
    def.attachments.clear(); // free: the residual of the solve moves the whole body
    together.add(def);
    alone.add(fragmentAlone());
    const std::size_t first = startTogether(together, alone);
    for (std::size_t i = 0; i < first; ++i) together.soft().x[i] *= 1.0 + 0.05 * std::sin(static_cast<double>(i));
    for (int step = 0; step < 20; ++step) {
        CHECK(together.step(1e-3).has(physics::StepFlag::NotConverged));
        alone.step(1e-3);
        for (std::size_t i = 0; i < 4; ++i) CHECK(distance(together.soft().v[first + i], alone.soft().v[i]) < 1e-3);
    }
}

TEST_CASE("a piece knows whether pins hold it, also after pins are released or tuned")
{
    physics::SoftBodyDef def = blockAndFragment();
    const auto node = static_cast<int>(std::get<std::shared_ptr<const geometry::TetMesh>>(def.mesh)->nodes.size()) - 1;
    def.attachments.push_back({.nodes = {node}, .stiffness = 1e-3});
    Stage stage;
    stage.add(def);
    stage.step(0.0);
    const auto held = [&] { return std::vector<bool>{stage.model().pieces[0].held, stage.model().pieces[1].held}; };
    REQUIRE(stage.model().pieces.size() == 2);
    CHECK(held() == std::vector{true, true});
    const auto spinsOn = [&] { // faster than allowed for an unpinned piece
        spin(stage, stage.model().pieces[1], {2e3, 0, 0});
        const SoftState before = stage.soft();
        limitSpin(stage.model(), 0.25, 1e-3, stage.soft());
        return stage.soft().v == before.v;
    };
    CHECK(spinsOn());
    stage.post(physics::Release{{2}});
    stage.step(0.0);
    CHECK(held() == std::vector{true, false});
    CHECK_FALSE(spinsOn());
    stage.post(physics::Tune{[node](physics::PhysicsEngine& engine) {
        dynamic_cast<World&>(engine).scene().soft[0].model.pins.springs = {{node, {}, 1e-3}};
    }});
    stage.step(0.0);
    CHECK(held() == std::vector{true, true});
    stage.post(physics::Release{{1}});
    stage.step(0.0);
    CHECK(held() == std::vector{false, true});
}

TEST_CASE("loose pieces side by side between two plates take few iterations")
{
    const auto iterations = [](int pieces) {
        geometry::TetMesh mesh;
        for (int i = 0; i < pieces; ++i) {
            const geometry::TetMesh one = boxMesh({1, 1, 1}, {2e-3, 2e-3, 2e-3});
            const auto first = static_cast<int>(mesh.nodes.size());
            for (Vec3 node : one.nodes) mesh.nodes.push_back(node + Vec3{3e-3 * (i % 4), 0, 3e-3 * (i / 4)});
            for (const geometry::Tetrahedron& t : one.tetrahedra)
                mesh.tetrahedra.push_back({first + t[0], first + t[1], first + t[2], first + t[3]});
        }
        Stage stage;
        stage.add(physics::SoftBodyDef{.mesh = shared(std::move(mesh)),
                                       .material = physics::FemMaterial{.youngModulus = 5e3},
                                       .collision = {{}},
                                       .dynamicTopology = true});
        physics::RigidBodyDef plate{.mesh = geometry::shapes::box({0.1, 0.02, 0.1}), .collision = {{}}};
        plate.elements = {{{0, -0.0105, 0}, {}}};
        stage.add(plate);
        plate.elements = {{{0, 0.0125, 0}, {}}};
        const BodyId lid = stage.add(plate);
        double sum = 0.0;
        for (int i = 1; i <= 100; ++i) {
            stage.post(physics::SetPose{lid, 0, Pose{{0, 0.0125 - 1e-5 * i, 0}, {}}});
            sum += stage.step(1e-3).solves[0].iterations;
        }
        return sum / 100.0;
    };
    const double one = iterations(1), twelve = iterations(12);
    INFO(one << " and " << twelve);
    CHECK(twelve < 2.0 * one);
}

} // namespace loose_pieces_test
