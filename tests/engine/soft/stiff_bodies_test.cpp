#include "engine/stage.h"

#include "filasofia/geometry/shapes.h"

#include <algorithm>
#include <map>

namespace stiff_bodies_test {

using namespace filasofia;
using namespace filasofia::engine;

// Bodies that are stiff for their step: h (h + b) E / (density cell^2) is 1e3 and more.
namespace {

physics::SoftBodyDef block(Vec3 size, std::array<int, 3> cells, const physics::FemMaterial& material)
{
    return {.name = "block", .mesh = geometry::shapes::block(size, cells), .material = material};
}

physics::RigidBodyDef floorAt(double y)
{
    return {.name = "floor",
            .elements = {{{0, y - 0.05, 0}, {}}},
            .mesh = geometry::shapes::box({0.4, 0.1, 0.4}),
            .collision = {{}}};
}

Vec3 angularMomentum(const SoftModel& model, const SoftState& state)
{
    Vec3 sum, centre;
    double mass = 0.0;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
        mass += model.masses[i];
        centre += model.masses[i] * state.x[i];
    }
    centre = 1.0 / mass * centre;
    for (std::size_t i = 0; i < state.x.size(); ++i) sum += model.masses[i] * cross(state.x[i] - centre, state.v[i]);
    return sum;
}

double fastest(const SoftState& state)
{
    double most = 0.0;
    for (Vec3 v : state.v) most = std::max(most, length(v));
    return most;
}

/// Boxes of 10 mm in a row, each joined to the next by one corner.
geometry::TetMesh cornerToCorner(int boxes)
{
    geometry::TetMesh chain;
    const auto box = geometry::shapes::block({0.01, 0.01, 0.01}, {1, 1, 1});
    std::map<std::array<long, 3>, int> known; // places [um]
    for (int k = 0; k < boxes; ++k) {
        const double aside = 0.01 * (k % 2);
        std::vector<int> nodes;
        for (const Vec3& node : box->nodes) {
            const Vec3 at = node + Vec3{0.01 * k, aside, aside};
            const std::array<long, 3> place{std::lround(1e6 * at.x), std::lround(1e6 * at.y), std::lround(1e6 * at.z)};
            const auto [found, isNew] = known.try_emplace(place, static_cast<int>(chain.nodes.size()));
            if (isNew) chain.nodes.push_back(at);
            nodes.push_back(found->second);
        }
        for (geometry::Tetrahedron t : box->tetrahedra) {
            for (int& node : t) node = nodes[static_cast<std::size_t>(node)];
            chain.tetrahedra.push_back(t);
        }
    }
    return chain;
}

} // namespace

TEST_CASE("boxes joined by corners that fall about one of them never move with more energy than they began with")
{
    for (const double young : {2e4, 1e6})
        for (const double dt : {1e-3, 1e-2}) {
            Stage stage({.period = dt, .threads = 1});
            physics::SoftBodyDef def{.mesh = shared(cornerToCorner(4)), .material = physics::FemMaterial{young, 0.49}};
            REQUIRE(physics::loadMesh(def)->nodes.size() == 29);
            def.attachments = {{.nodes = {0}}};
            const BodyId chain = stage.add(def);
            stage.post(physics::SetGravity{{0, -9.81, 0}});
            stage.step(0.0);
            const double start = stage.world.energyOf(chain).gravitational;
            double moving = start, all = start, lowest = start;
            for (int i = 0; i < std::lround(1.0 / dt); ++i) {
                stage.step(dt);
                const physics::MechanicalEnergy now = stage.world.energyOf(chain);
                moving = std::max(moving, now.kinetic + now.gravitational);
                all = std::max(all, now.kinetic + now.gravitational + now.elastic);
                lowest = std::min(lowest, now.gravitational);
            }
            const double fall = start - lowest;
            CHECK(fall > 1e-4); // [J]
            CHECK(moving == start);
            // A linear step stretches what it rotates; the next one lets it go.
            CHECK(all < start + (dt < 5e-3 ? 0.01 : 2.0) * fall);
        }
}

TEST_CASE("a stiff body that spins freely conserves linear and angular momentum")
{
    for (const double young : {1e6, 1e8}) {
        Stage stage;
        physics::SoftBodyDef def = block({0.01, 0.01, 0.01}, {4, 4, 4}, {.youngModulus = young, .poissonRatio = 0.45});
        def.gravity = false;
        def.rayleigh = {0.0, 0.01};
        stage.add(def);
        stage.step(1e-3);
        for (std::size_t i = 0; i < stage.soft().v.size(); ++i)
            stage.soft().v[i] = Vec3{0.1, 0, 0} + cross(Vec3{1, 3, 2}, stage.soft().x[i]);
        const Vec3 before = angularMomentum(stage.model(), stage.soft());
        stage.run(500, 1e-3);
        const Vec3 now = angularMomentum(stage.model(), stage.soft());
        CHECK(length(now - before) <= 1e-3 * length(before));
        Vec3 momentum;
        double mass = 0.0;
        for (std::size_t i = 0; i < stage.soft().v.size(); ++i) {
            momentum += stage.model().masses[i] * stage.soft().v[i];
            mass += stage.model().masses[i];
        }
        CHECK(length(1.0 / mass * momentum - Vec3{0.1, 0, 0}) <= 1e-5);
    }
}

TEST_CASE("a stiff free body comes to rest on a floor")
{
    for (const double young : {1e6, 1e7, 1e9}) {
        INFO("E " << young);
        Stage stage;
        stage.add(floorAt(0.0));
        physics::SoftBodyDef def = block({0.01, 0.01, 0.01}, {4, 4, 4}, {.youngModulus = young, .poissonRatio = 0.45});
        def.pose.position = {0, 0.0055, 0};
        def.collision = {{}};
        stage.add(def);
        stage.run(400, 1e-3);
        CHECK(fastest(stage.soft()) < (young < 1e8 ? 1e-3 : 3e-3)); // at 1 GPa rounding of positions shakes it
        const auto lowest = std::ranges::min(stage.soft().x, {}, &Vec3::y).y;
        CHECK(std::abs(lowest) < 5e-4);
    }
}

TEST_CASE("a thin sheet comes to rest on a floor")
{
    Stage stage;
    stage.add(floorAt(0.0));
    physics::SoftBodyDef def = block({0.1, 0.0015, 0.1}, {10, 1, 10}, {.youngModulus = 3e4, .poissonRatio = 0.3});
    def.pose.position = {0, 0.00085, 0};
    def.collision = {{.proximity = 0.2e-3}};
    stage.add(def);
    stage.run(300, 1e-3);
    CHECK(fastest(stage.soft()) < 1e-4);
    CHECK(stage.step(1e-3).solves[0].iterations < 60);
}

TEST_CASE("a nearly incompressible body keeps its direct solver in contact")
{
    Stage stage;
    stage.add(floorAt(0.0));
    physics::SoftBodyDef def = block({0.02, 0.02, 0.02}, {3, 3, 3}, {.youngModulus = 1e4, .poissonRatio = 0.4999});
    def.pose.position = {0, 0.0102, 0};
    def.collision = {{}};
    stage.add(def);
    const physics::StepReport report = stage.run(300, 1e-3);
    CHECK_FALSE(report.has(physics::StepFlag::NotConverged));
    CHECK(fastest(stage.soft()) < 1e-3);
    CHECK(report.solves[0].iterations < 60);
}

TEST_CASE("a light soft body pinned by springs and pulled by jaws takes few iterations")
{
    // It is stiff for its mass, as damped tissue is: the coarse level treats it as free.
    Stage stage;
    physics::SoftBodyDef def = block({0.006, 0.012, 0.006}, {4, 8, 4}, {.youngModulus = 8e3, .poissonRatio = 0.4});
    def.rayleigh = {10.0, 0.02};
    physics::RigidBodyDef jaw{.name = "jaw"};
    const BodyId tool = stage.add(jaw);
    physics::AttachmentDef low{.box = geometry::Box{{-1, -1, -1}, {1, -0.0059, 1}}, .stiffness = 40.0};
    physics::AttachmentDef high{.box = geometry::Box{{-1, 0.0059, -1}, {1, 1, 1}}, .stiffness = 300.0, .to = tool};
    low.to = stage.add(physics::RigidBodyDef{.name = "wall"});
    def.attachments = {low, high};
    stage.add(def);
    int most = 0;
    for (int i = 1; i <= 100; ++i) {
        stage.post(physics::SetPose{tool, 0, Pose{{0, 5e-5 * i, 0}, {}}});
        most = std::max(most, stage.step(1e-3).solves[0].iterations);
    }
    CHECK(most <= 20);
}

} // namespace stiff_bodies_test
