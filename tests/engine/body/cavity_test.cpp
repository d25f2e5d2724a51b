#include "filasofia/engine/body/cavity.h"

#include "filasofia/core/log.h"
#include "filasofia/engine/step/fill_cavities.h"
#include "filasofia/geometry/shapes.h"

#include "engine/stage.h"

#include <numbers>

namespace cavity_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;
namespace shapes = filasofia::geometry::shapes;

namespace {

constexpr double kPi = std::numbers::pi;

/// A bladder of 2 cm, with a wall of 2 mm.
SoftBodyDef bladder(const CavityDef& cavity, double young = 10e3)
{
    return {.mesh = shapes::bladder({0.02, 0.02, 0.02}, 2e-3, {5, 1}),
            .material = FemMaterial{.youngModulus = young, .poissonRatio = 0.4},
            .rayleigh = {0.0, 0.0},
            .gravity = false,
            .cavities = {cavity}};
}

const frame::Cavity& report(Stage& stage, std::size_t at = 0) { return stage.world.scene().cavityReports.at(at); }

/// Moves every node by something smooth and small.
std::vector<Vec3> shaken(const std::vector<Vec3>& rest, double by)
{
    std::vector<Vec3> x = rest;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const auto phase = static_cast<double>(i);
        x[i] += by * Vec3{std::sin(1.3 * phase), std::cos(2.1 * phase), std::sin(0.7 * phase + 1.0)};
    }
    return x;
}

/// The forces that cavities add at a state at rest.
std::vector<Vec3> forcesAt(Stage& stage, const std::vector<Vec3>& x, Vec3 gravity = {})
{
    SoftState state = stage.soft();
    state.x = x;
    std::vector<Vec3> forces(x.size());
    std::vector<RankOneStiffness> stiffness;
    addCavityForces({gravity, 1e-3}, stage.model(), state, forces, stiffness);
    return forces;
}

/// [J] The work that the fill has still to give: its pressure is minus the derivative.
double energyOf(const Cavity& cavity, const CavityState& state, const std::vector<Vec3>& x)
{
    const double v = volumeOf(cavity, x);
    if (cavity.def.fill == CavityFill::Gas) return -state.content * std::log(v) + kAtmosphere * v;
    const double stiffness = cavity.def.bulkModulus / cavity.restVolume;
    return 0.5 * stiffness * (v - state.content) * (v - state.content);
}

} // namespace

TEST_CASE("a cavity's volume is that inside the mesh, and what is outside is no cavity")
{
    Stage stage;
    stage.add(bladder({}));
    stage.step(0.0);
    const Cavity& cavity = stage.model().cavities.at(0);
    CHECK(cavity.restVolume == Approx(4.0 / 3.0 * kPi * 8e-6).epsilon(0.06)); // flat triangles inside the sphere
    CHECK(cavity.wall.size() == 200);
    CHECK_FALSE(cavity.isOpen());
    CHECK(std::ranges::count(stage.model().wallOf, 0) == 200);
    CHECK(std::ranges::count(stage.model().wallOf, -1) == 200);
    CHECK(report(stage).volume == Approx(cavity.restVolume).epsilon(1e-12));
    // Far from the origin no digits are lost.
    std::vector<Vec3> far = stage.model().rest;
    for (Vec3& each : far) each += Vec3{500.0, -300.0, 800.0};
    CHECK(volumeOf(cavity, far) == Approx(cavity.restVolume).epsilon(1e-10));
}

TEST_CASE("the forces of a fill are the derivative of its energy, and sum up to its weight")
{
    for (const CavityFill fill : {CavityFill::Gas, CavityFill::Liquid}) {
        Stage stage;
        SoftBodyDef def = bladder({.fill = fill, .pressure = 2e3});
        def.gravity = true;
        stage.add(def);
        stage.step(0.0);
        const Cavity& cavity = stage.model().cavities.at(0);
        const CavityState& state = stage.soft().cavities.at(0);
        const std::vector<Vec3> x = shaken(stage.model().rest, 1e-4);
        const std::vector<Vec3> forces = forcesAt(stage, x);
        Vec3 sum, moment;
        double largest = 0.0, error = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i) {
            sum += forces[i];
            moment += cross(x[i], forces[i]);
            largest = std::max(largest, length(forces[i]));
            for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
                std::vector<Vec3> more = x, less = x;
                constexpr double h = 1e-6;
                more[i] += h * axis;
                less[i] = less[i] - h * axis;
                const double slope = (energyOf(cavity, state, more) - energyOf(cavity, state, less)) / (2.0 * h);
                error = std::max(error, std::abs(dot(forces[i], axis) + slope));
            }
        }
        CHECK(largest > 1e-3);
        CHECK(error < 1e-5 * largest);
        CHECK(length(sum) < 1e-12);
        CHECK(length(moment) < 1e-13);
        const Vec3 gravity{0.0, -9.81, 0.0};
        const std::vector<Vec3> heavy = forcesAt(stage, x, gravity);
        Vec3 weight;
        for (std::size_t i = 0; i < x.size(); ++i) weight += heavy[i] - forces[i];
        const double expected = fill == CavityFill::Liquid ? 1000.0 * volumeOf(cavity, x) * 9.81 : 0.0;
        CHECK(std::abs(weight.y + expected) < 1e-10);
        CHECK(std::abs(weight.x) + std::abs(weight.z) < 1e-10);
    }
}

TEST_CASE("a gas keeps its pressure times its volume, and a liquid nearly its volume")
{
    for (const CavityFill fill : {CavityFill::Gas, CavityFill::Liquid, CavityFill::Source}) {
        Stage stage;
        SoftBodyDef def = bladder({.fill = fill, .pressure = 500.0, .bulkModulus = 1e6});
        def.pressure = fill == CavityFill::Source ? 700.0 : 3e3; // from outside
        def.rayleigh = {10.0, 0.01};
        stage.add(def);
        CHECK(stage.run(1000, 2e-3).flags == 0);
        const frame::Cavity& now = report(stage);
        const Cavity& cavity = stage.model().cavities.at(0);
        INFO("fill " << static_cast<int>(fill) << ", volume " << now.volume << " of " << cavity.restVolume
                     << ", pressure " << now.pressure);
        CHECK(now.volume < cavity.restVolume);
        if (fill == CavityFill::Source) CHECK(now.pressure == 500.0);
        if (fill == CavityFill::Gas)
            CHECK((now.pressure + kAtmosphere) * now.volume ==
                  Approx((500.0 + kAtmosphere) * cavity.restVolume).epsilon(1e-12));
        if (fill == CavityFill::Liquid) {
            CHECK(now.volume > 0.995 * cavity.restVolume);
            CHECK(now.pressure ==
                  Approx(500.0 + 1e6 * (cavity.restVolume - now.volume) / cavity.restVolume).epsilon(1e-9));
        }
        CHECK(now.pressure > 0.0);
    }
}

TEST_CASE("a soft bladder full of gas breathes at the frequency of its wall's mass and the gas")
{
    Stage stage;
    stage.add(bladder({.pressure = 0.0}, 1.0)); // the wall's own stiffness is nothing beside the gas's
    stage.step(0.0);
    const SoftModel& model = stage.model();
    const Cavity& cavity = model.cavities.at(0);
    // The mode of M x'' = -k g (g . x) is x = M^-1 g, and its frequency is the root of k g . M^-1 g.
    std::vector<Vec3> forces(model.rest.size());
    std::vector<RankOneStiffness> stiffness;
    addCavityForces({{}, 1.0}, model, stage.soft(), forces, stiffness); // h = 1 s: the weight is k
    double perMass = 0.0;
    for (std::size_t i = 0; i < stiffness[0].nodes.size(); ++i) {
        const auto node = static_cast<std::size_t>(stiffness[0].nodes[i]);
        const Vec3 gradient = stiffness[0].gradient[i];
        stage.soft().v[node] = 1e-4 / model.masses[node] * gradient;
        perMass += dot(gradient, gradient) / model.masses[node];
    }
    CHECK(stiffness[0].weight == Approx(kAtmosphere / cavity.restVolume));
    const double expected = 2.0 * kPi / std::sqrt(stiffness[0].weight * perMass);
    constexpr double dt = 2e-6;
    double before = cavity.restVolume, ends = 0.0;
    int crossings = 0;
    for (int i = 1; crossings < 2 && i < 20000; ++i) {
        stage.step(dt);
        const double now = report(stage).volume - cavity.restVolume, last = before - cavity.restVolume;
        if (i > 1 && (now < 0.0) != (last < 0.0)) ++crossings, ends = dt * (i - 1 + last / (last - now));
        before = report(stage).volume;
    }
    INFO("period " << ends << " s, expected " << expected);
    CHECK(crossings == 2);
    CHECK(ends == Approx(expected).epsilon(0.02));
}

TEST_CASE("a bladder on a source swells as Lame's thick sphere does, the nearer the finer it is")
{
    constexpr double a = 0.01, b = 0.02, p = 100.0, young = 10e3, nu = 0.3;
    // u(b) = p a^3 b / (E (b^3 - a^3)) * 3 (1 - nu) / 2
    const double expected = p * a * a * a * b / (young * (b * b * b - a * a * a)) * 1.5 * (1.0 - nu);
    const auto error = [&](std::array<int, 2> cells) {
        Stage stage;
        stage.add(SoftBodyDef{.mesh = shapes::bladder({a, a, a}, b - a, cells),
                              .material = FemMaterial{.youngModulus = young, .poissonRatio = nu},
                              .rayleigh = {20.0, 0.01},
                              .gravity = false,
                              .cavities = {{.fill = CavityFill::Source, .pressure = p}}});
        stage.run(400, 5e-3);
        const SoftModel& model = stage.model();
        double swollen = 0.0, nodes = 0.0;
        for (std::size_t i = 0; i < model.rest.size(); ++i)
            if (length(model.rest[i]) > b - 1e-9) swollen += length(stage.soft().x[i]) - b, nodes += 1.0;
        return std::abs(swollen / nodes / expected - 1.0);
    };
    const double coarse = error({4, 2}), fine = error({8, 4});
    INFO("relative errors " << coarse << " and " << fine);
    CHECK(fine < 0.04);
    CHECK(fine < 0.4 * coarse);
}

TEST_CASE("inflow fills a bladder by what flows in, and a command sets its pressure")
{
    for (const CavityFill fill : {CavityFill::Gas, CavityFill::Liquid}) {
        Stage stage;
        SoftBodyDef def = bladder({.fill = fill}, 30e3);
        def.rayleigh = {20.0, 0.01};
        const BodyId id = stage.add(def);
        stage.step(1e-3);
        const double before = report(stage).volume;
        stage.post(SetCavity{.id = id, .inflow = 1e-6});
        stage.run(1000, 1e-3);
        stage.post(SetCavity{.id = id, .inflow = 0.0});
        stage.run(500, 1e-3);
        const frame::Cavity now = report(stage);
        const double got = fill == CavityFill::Gas
                               ? (now.pressure + kAtmosphere) * now.volume / kAtmosphere - before
                               : now.volume + now.pressure / 1e6 * stage.model().cavities[0].restVolume - before;
        CHECK(got == Approx(1e-6).epsilon(1e-3));
        CHECK(now.pressure > 50.0);
        stage.post(SetCavity{.id = id, .pressure = 0.0}); // at the volume that it has now
        stage.step(1e-3);
        const double content = stage.soft().cavities[0].content / (fill == CavityFill::Gas ? kAtmosphere : 1.0);
        CHECK(content == Approx(now.volume).epsilon(1e-12));
    }
}

TEST_CASE("a closed shell has a cavity, and two cavities of a body are told apart by a point")
{
    Stage stage;
    SoftBodyDef ball{.mesh = shapes::sphere(0.03, 5),
                     .material = ShellMaterial{.youngModulus = 100e3, .poissonRatio = 0.3, .thickness = 1e-3},
                     .gravity = false,
                     .cavities = {{.fill = CavityFill::Source, .pressure = 50.0}}};
    stage.add(ball);
    stage.run(1000, 1e-3);
    const double strain = 50.0 * 0.03 * (1.0 - 0.3) / (2.0 * 1e-3 * 100e3); // p r (1 - nu) / (2 t E)
    CHECK(report(stage).volume / stage.model().cavities[0].restVolume ==
          Approx(std::pow(1.0 + strain, 3)).epsilon(0.05 * 3.0 * strain));

    geometry::TetMesh two = *shapes::bladder({0.02, 0.02, 0.02}, 2e-3, {4, 1});
    const geometry::TetMesh small = *shapes::bladder({0.01, 0.01, 0.01}, 2e-3, {4, 1});
    const auto offset = static_cast<int>(two.nodes.size());
    for (Vec3 node : small.nodes) two.nodes.push_back(node + Vec3{0.1, 0, 0});
    for (geometry::Tetrahedron t : small.tetrahedra) {
        for (int& node : t) node += offset;
        two.tetrahedra.push_back(t);
    }
    Stage pair;
    SoftBodyDef def{.mesh = shared(two), .gravity = false, .cavities = {{}, {}}};
    pair.add(def);
    pair.step(0.0);
    CHECK(report(pair, 0).volume > report(pair, 1).volume); // the largest first
    def.cavities = {{.at = Vec3{0.1, 0.001, 0}}};
    Stage named;
    named.add(def);
    named.step(0.0);
    CHECK(named.world.scene().cavityReports.size() == 1);
    CHECK(report(named).volume == Approx(report(pair, 1).volume));
}

TEST_CASE("a cavity that cannot be is one error with the body's name")
{
    Stage stage;
    SoftBodyDef def = bladder({});
    def.name = "bag";
    def.cavities = {{}, {}};
    CHECK_THROWS_WITH(stage.add(def), "soft body 'bag': cavities[1]: the mesh has only 1 closed inner surfaces");
    def.cavities = {{.at = Vec3{0.5, 0, 0}}};
    CHECK_THROWS_WITH(stage.add(def), "soft body 'bag': cavities[0].at must lie in a cavity of the mesh that no other "
                                      "entry has, got 0.5 0 0 m; the mesh has 1 closed inner surfaces");
    def.cavities = {{.pressure = -2e5}};
    CHECK_THROWS_WITH(stage.add(def),
                      "soft body 'bag': cavities[0].pressure must be in (-101325, 100000000) Pa, got -200000");
    def.cavities = {{.fill = CavityFill::Liquid, .pressure = -2e3, .bulkModulus = 1e3}};
    CHECK_THROWS_WITH(stage.add(def), "soft body 'bag': cavities[0].pressure must be > -bulkModulus, -1000 Pa, for a "
                                      "liquid, got -2000");
    def.cavities = {{}};
    def.solver = Cholesky{};
    CHECK_THROWS_WITH(stage.add(def), "soft body 'bag': cavities need the default solver, got Cholesky");
    def.solver = ConjugateGradient{};
    def.integrator = ExplicitEuler{};
    CHECK_THROWS_WITH(stage.add(def), "soft body 'bag': cavities need integrator ImplicitEuler, got ExplicitEuler");
    def.integrator = ImplicitEuler{};
    def.mesh = shared(boxMesh({2, 2, 2}, {0.1, 0.1, 0.1}));
    CHECK_THROWS_WITH(stage.add(def), "soft body 'bag': cavities[0]: the mesh has no closed inner surfaces");
    def.material = ShellMaterial{};
    def.mesh = shapes::sheet(0.1, 0.1);
    CHECK_THROWS_WITH(
        stage.add(def),
        "soft body 'bag': cavities[0]: the mesh has no closed shells that face outwards; some edges have one triangle");
}

TEST_CASE("a cut through the wall opens a cavity: what flows out obeys Torricelli, and all of it is counted")
{
    Stage stage;
    const double bulk = GENERATE(1e6, 2.2e9);
    SoftBodyDef def = bladder({.fill = CavityFill::Liquid, .bulkModulus = bulk}, 20e3);
    def.rayleigh = {5.0, 0.01};
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, -0.018, 1}}}};
    def.dynamicTopology = true;
    const BodyId id = stage.add(def);
    const geometry::TriangleMesh square{
        .vertices = {{-0.01, 0, -1e-4}, {0.01, 0, -1e-4}, {0.01, 0.04, -1e-4}, {-0.01, 0.04, -1e-4}},
        .triangles = {{0, 1, 2}, {0, 2, 3}},
        .uv = {}};
    const auto at = [](double y) { return Pose{.position = {0.001, y, 0.0007}}; };
    const BodyId blade = stage.add(RigidBodyDef{
        .elements = {at(0.03)},
        .collision = {
            {.mesh = std::make_shared<const geometry::TriangleMesh>(square), .proximity = 0, .cutting = true}}});
    stage.post(SetCavity{.id = id, .inflow = 4e-6});
    stage.run(1000, 1e-3);
    stage.post(SetCavity{.id = id, .inflow = 0.0});
    stage.run(200, 1e-3);
    const double full = report(stage).pressure;
    CHECK(full > 200.0);
    const double content = stage.soft().cavities[0].content;
    CHECK(content > stage.model().cavities[0].restVolume);
    double worst = 0.0;
    bool wasOpen = false;
    int opened = 0;
    for (int i = 0; i < 1500; ++i) {
        const double y = i < 300 ? 0.03 - 0.016 * i / 300.0 : i < 600 ? 0.014 + 0.016 * (i - 300) / 300.0 : 0.03;
        stage.post(SetPose{blade, 0, at(y)});
        const double pressure = i > 0 ? report(stage).pressure : full;
        for (const Rupture& each : stage.step(1e-3).topology.ruptures) opened += static_cast<int>(each.cavities.size());
        const frame::Cavity& now = report(stage);
        if (!now.open) CHECK(now.lost == 0.0);
        wasOpen = wasOpen || now.open;
        // Against the pressure and the opening of the step before, which the step is solved with.
        if (now.open && pressure > 50.0 && now.opening > 1e-8)
            worst = std::max(worst, now.outflow / (0.61 * now.opening * std::sqrt(2.0 * pressure / 1000.0)));
    }
    const frame::Cavity& now = report(stage);
    CHECK(wasOpen);
    CHECK(opened == 1); // told once
    CHECK(now.open);
    CHECK(stage.soft().cavities[0].content + now.lost == Approx(content).epsilon(1e-12));
    CHECK(now.lost > 0.3 * (content - stage.model().cavities[0].restVolume));
    INFO("largest outflow over Torricelli's " << worst << ", pressure at the end " << now.pressure);
    CHECK(worst < 1.01);
    CHECK(now.pressure < 0.7 * full); // the slit closes as the wall relaxes

    // A motion as a whole changes no volume, open or not, and the gradient is that of the volume, lids included.
    const Cavity& cavity = stage.model().cavities.at(0);
    SoftState moving = stage.soft();
    std::ranges::fill(moving.v, Vec3{3.0, -2.0, 1.0});
    std::vector<Vec3> still(moving.x.size()), carried(moving.x.size()), heavy(moving.x.size());
    std::vector<RankOneStiffness> stiffness;
    addCavityForces({{}, 1e-3}, stage.model(), moving, carried, stiffness);
    std::ranges::fill(moving.v, Vec3{});
    addCavityForces({{}, 1e-3}, stage.model(), moving, still, stiffness);
    double apart = 0.0, slope = 0.0;
    Vec3 weight;
    SoftModel weighed = stage.model();
    weighed.gravity = true;
    addCavityForces({{0, -9.81, 0}, 1e-3}, weighed, moving, heavy, stiffness);
    for (std::size_t i = 0; i < still.size(); ++i) {
        apart = std::max(apart, length(still[i] - carried[i]));
        weight += heavy[i] - still[i];
    }
    for (std::size_t i = 0; i < stiffness[0].nodes.size(); i += 7)
        for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
            std::vector<Vec3> more = moving.x, less = moving.x;
            const auto node = static_cast<std::size_t>(stiffness[0].nodes[i]);
            more[node] += 1e-6 * axis;
            less[node] = less[node] - 1e-6 * axis;
            slope = std::max(slope, std::abs((volumeOf(cavity, more) - volumeOf(cavity, less)) / 2e-6 -
                                             dot(stiffness[0].gradient[i], axis)));
        }
    CHECK(apart < 1e-9);
    CHECK(slope < 1e-9);
    CHECK(weight.y == Approx(-9.81 * 1000.0 * volumeOf(cavity, moving.x)).epsilon(0.03)); // it is open at the top

    stage.post(Reset{});
    stage.step(1e-3);
    CHECK_FALSE(report(stage).open);
    CHECK(report(stage).lost == 0.0);
    CHECK(stage.model().cavities[0].wall.size() == 200);
}

TEST_CASE("a bladder full of water falls as a stone does, and its weight is that of both")
{
    Stage stage;
    SoftBodyDef def = bladder({.fill = CavityFill::Liquid}, 100e3);
    def.gravity = true;
    stage.add(def);
    stage.post(SetGravity{{0, -9.81, 0}});
    stage.run(100, 1e-3);
    double mean = 0.0, mass = 0.0, without = 0.0;
    const SoftModel& model = stage.model();
    for (std::size_t i = 0; i < model.rest.size(); ++i) {
        mean += model.masses[i] * stage.soft().v[i].y;
        mass += model.masses[i];
        without += model.masses[i] - model.filling[i];
    }
    CHECK(mean / mass == Approx(-0.981).epsilon(0.01));
    CHECK(mass - without == Approx(1000.0 * model.cavities[0].restVolume).epsilon(1e-9));
    CHECK(report(stage).volume == Approx(model.cavities[0].restVolume).epsilon(1e-3));
}

TEST_CASE("a cavity that is drained or sucked empty stops there, without turning inside out")
{
    for (const CavityFill fill : {CavityFill::Liquid, CavityFill::Source, CavityFill::Gas}) {
        const bool sucked = fill == CavityFill::Source;
        Stage stage;
        SoftBodyDef def = bladder({.fill = fill, .pressure = sucked ? -2e3 : 0}, 30e3);
        def.rayleigh = {20.0, 0.01};
        const BodyId id = stage.add(def);
        if (!sucked) stage.post(SetCavity{.id = id, .inflow = -60e-6});
        double least = 1.0;
        for (int i = 0; i < 1000; ++i) {
            stage.step(1e-3);
            least = std::min(least, report(stage).volume / stage.model().cavities[0].restVolume);
        }
        INFO("fill " << static_cast<int>(fill) << ", smallest part of the volume " << least);
        CHECK(least > -0.05);
        CHECK(stage.soft().cavities[0].warned == (least < 0.02));
    }
}

TEST_CASE("a bladder that is filled, pressed and cut has the same bits for any number of threads, and after a restore")
{
    const auto run = [](int threads, bool restores) {
        Stage stage({.threads = threads});
        SoftBodyDef def = bladder({.fill = CavityFill::Gas, .pressure = 300.0});
        const BodyId id = stage.add(def);
        stage.run(20, 1e-3);
        if (restores) {
            const auto saved = stage.world.save();
            stage.run(7, 1e-3);
            stage.world.restore(*saved);
        }
        stage.post(SetCavity{.id = id, .inflow = 1e-6});
        stage.run(30, 1e-3);
        return stage.world.hash();
    };
    const std::uint64_t one = run(1, false);
    CHECK(run(2, false) == one);
    CHECK(run(3, true) == one);
}

TEST_CASE("a cavity that is emptied is told of, unless its walls collide with each other")
{
    for (const bool self : {false, true}) {
        Stage stage;
        SoftBodyDef def = bladder({.fill = CavityFill::Gas});
        def.collision = {{.self = self}};
        stage.add(def);
        stage.step(0.0);
        for (Vec3& x : stage.soft().x) x = 0.2 * x; // less than a hundredth of its volume
        std::string logged;
        setLogSink([&](LogLevel, std::string_view line) { logged += line; });
        stage.step(1e-6);
        setLogSink({});
        REQUIRE(report(stage).volume < 0.02 * stage.model().cavities[0].restVolume);
        CHECK((logged.find("cavities[0] is empty: without self-collision its walls") != std::string::npos) == !self);
    }
}

} // namespace cavity_test
