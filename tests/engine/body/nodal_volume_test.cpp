#include "engine/elastic/laws.h"
#include "engine/stage.h"
#include "engine/volumes.h"

namespace nodal_volume_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// A free box in two parts, the upper of which is compressible if `mixed`.
SoftBodyDef box(double nu, bool mixed = false)
{
    SoftBodyDef def = freeBody(boxMesh({3, 3, 3}, {0.03, 0.03, 0.03}, 0.2));
    FemMaterial material{.youngModulus = 5e3, .poissonRatio = nu};
    if (mixed) material.regions = {{.where = geometry::Box{{-1, -1, 0.015}, {1, 1, 1}}, .poissonRatio = 0.3}};
    def.material = material;
    return def;
}

double energyAt(const SoftModel& model, const std::vector<Vec3>& x)
{
    double sum = nodalEnergy(model, x);
    for (const FemElement& element : model.elements) {
        Corners corners;
        for (std::size_t i = 0; i < 4; ++i) corners[i] = x[element.nodes[i]];
        sum += engine::energyOf(model.material.law, element, corners);
    }
    return sum;
}

void deform(SoftState& state)
{
    std::mt19937 random(7);
    for (Vec3& x : state.x) x = 1.1 * x + randomVec3(random, 1e-3);
}

} // namespace

TEST_CASE("the forces of an element's law and of nodal volumes are the gradient of their energy")
{
    const bool mixed = GENERATE(false, true);
    SoftBodyDef def = box(0.49, mixed);
    def.integrator = ExplicitEuler{};
    Stage stage;
    stage.add(def);
    stage.step(0.0);
    deform(stage.soft());
    const std::vector<Vec3> forces = forcesNow(stage);
    const SoftModel& model = stage.model();
    REQUIRE(model.nodalVolumes);
    double largest = 0.0, error = 0.0;
    for (std::size_t n = 0; n < forces.size(); ++n)
        for (int k = 0; k < 3; ++k) {
            std::vector<Vec3> more = stage.soft().x, less = more;
            constexpr double kStep = 1e-7;
            more[n][k] += kStep;
            less[n][k] -= kStep;
            const double slope = (energyAt(model, more) - energyAt(model, less)) / (2.0 * kStep);
            largest = std::max(largest, std::abs(slope));
            error = std::max(error, std::abs(forces[n][k] + slope));
        }
    CHECK(error < 1e-5 * largest);
}

TEST_CASE("a homogeneous change of volume is resisted with the whole bulk modulus, shear with mu")
{
    Stage stage;
    stage.add(box(0.49));
    stage.step(0.0);
    const SoftModel& model = stage.model();
    const Lame all = lame(5e3, 0.49);
    std::vector<Vec3> grown = model.rest, sheared = model.rest;
    constexpr double kSmall = 1e-4;
    for (Vec3& x : grown) x = (1.0 + kSmall) * x;
    for (Vec3& x : sheared) x.x += kSmall * x.y;
    const double volume = 0.03 * 0.03 * 0.03, bulk = all.lambda + 2.0 / 3.0 * all.mu;
    CHECK(energyAt(model, grown) == Approx(4.5 * bulk * kSmall * kSmall * volume).epsilon(1e-3));
    CHECK(energyAt(model, sheared) == Approx(0.5 * all.mu * kSmall * kSmall * volume).epsilon(1e-3));
}

TEST_CASE("compressible elements take no part in nodal volumes, and a compressible body has none")
{
    Stage stage, plain;
    stage.add(box(0.49, true));
    plain.add(box(0.45));
    stage.step(0.0);
    plain.step(0.0);
    CHECK_FALSE(plain.model().nodalVolumes);
    CHECK(volumeChanges(plain.model(), plain.soft().x).empty());
    deform(stage.soft());
    const SoftModel& model = stage.model();
    const std::vector<double> changes = volumeChanges(model, stage.soft().x);
    int without = 0, with = 0;
    for (const FemElement& element : model.elements) {
        const double tension = nodalTension(element, changes);
        ++(element.poissonRatio < 0.4 ? without : with);
        CHECK((tension == 0.0) == (element.poissonRatio < 0.4));
    }
    CHECK(without > 20);
    CHECK(with > 20);
    for (std::size_t n = 0; n < changes.size(); ++n) // nodes of compressible elements alone
        if (model.rest[n].z > 0.0299) CHECK(changes[n] == 0.0);
}

TEST_CASE("the reaction of pins bears the weight of a nearly incompressible body at rest")
{
    const bool assembled = GENERATE(false, true);
    SoftBodyDef def = box(0.499);
    def.gravity = true;
    def.rayleigh = {.mass = 5.0, .stiffness = 0.02};
    def.solver = ConjugateGradient{.maxIterations = 3000, .tolerance = 1e-5, .assembled = assembled};
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}}};
    Stage stage;
    stage.add(def);
    stage.post(SetGravity{{0, -9.81, 0}});
    stage.run(400, 0.005);
    const double weight = 9.81 * 1000.0 * 0.03 * 0.03 * 0.03;
    const auto frame = stage.world.scene().attachmentReports;
    REQUIRE(frame.size() == 1);
    CHECK(frame[0].force.y == Approx(weight).epsilon(2e-3));
    CHECK(std::abs(frame[0].force.x) < 2e-3 * weight);
}

TEST_CASE("nodal volumes make the same bits for any number of threads")
{
    SoftBodyDef def = box(0.499);
    def.mesh = shared(boxMesh({11, 10, 9}, {0.05, 0.05, 0.05}, 0.2)); // many parts of every loop
    def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}}};
    def.gravity = true;
    def.solver = ConjugateGradient{};
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 8}) {
        Stage stage({.threads = threads});
        stage.add(def);
        stage.post(SetGravity{{3, -9.81, 1}});
        stage.run(20, 0.005);
        hashes.push_back(stage.world.hash());
    }
    CHECK(hashes[0] == hashes[1]);
    CHECK(hashes[0] == hashes[2]);
}

TEST_CASE("tissue that a command makes incompressible, and compressible again, is that of a body built so")
{
    const bool assembled = GENERATE(false, true);
    const auto moved = [&](double first, double then) {
        SoftBodyDef def = box(first);
        def.solver = ConjugateGradient{.maxIterations = 3000, .tolerance = 1e-6, .assembled = assembled};
        def.gravity = true;
        def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 1e-6, 1}}}};
        Stage stage;
        const BodyId id = stage.add(def);
        stage.step(0.0);
        if (then != first)
            stage.post(SetTissue{id, {.where = geometry::Box{{-1, -1, -1}, {1, 1, 1}}, .poissonRatio = then}});
        stage.post(SetGravity{{3, -9.81, 1}});
        stage.run(20, 0.005);
        return std::pair(stage.soft().x, stage.model().rest);
    };
    for (const auto& [a, b] : {std::pair{0.3, 0.49}, {0.49, 0.3}}) {
        const auto [changed, rest] = moved(a, b);
        const auto [built, same] = moved(b, b);
        const auto [before, alike] = moved(a, a);
        const double size = relativeDistance(built, rest, 1.0);
        CHECK(relativeDistance(changed, built, size) < 1e-3);
        CHECK(relativeDistance(changed, before, size) > 0.02);
    }
}

} // namespace nodal_volume_test
