#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/topology/tear_body.h"

#include "engine/stage.h"

namespace tearing_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

constexpr double kThreshold = 2e3; ///< [Pa]

/// A strip along x, pinned at its low end and pulled at its high end by a rigid clamp.
struct PulledStrip {
    Stage stage;
    BodyId strip, clamp;
    double start = 0.0, at = 0.0;

    PulledStrip(const SoftMaterial& material, double length, std::array<int, 3> cells)
    {
        const double width = 0.01;
        SoftBodyDef def{.mesh = shared(boxMesh(cells, {length, width, width})),
                        .material = material,
                        .gravity = false,
                        .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1e-6, 1, 1}}}},
                        .dynamicTopology = true};
        strip = stage.add(def);
        clamp = stage.add(RigidBodyDef{.name = "clamp", .elements = {Pose{.position = {length, 0, 0}}}});
        start = at = length;
        stage.post(Attach{
            AttachmentId{9},
            strip,
            {.box = geometry::Box{{length - 1e-6, -1, -1}, {length + 1e-6, 1, 1}}, .stiffness = kHard, .to = clamp}});
        stage.step(1e-3);
    }

    /// Pulls by `speed` [1/s] of the length until something tears or the strain reaches `maxStrain`. Returns the strain
    /// at which it tore.
    double pull(double speed, double maxStrain, double dt)
    {
        while (at < start * (1.0 + maxStrain)) {
            at += speed * start * dt;
            stage.post(SetPose{clamp, 0, Pose{.position = {at, 0, 0}}});
            for (const Rupture& rupture : stage.step(dt).topology.ruptures) {
                CHECK(rupture.kind == Rupture::Kind::Tear);
                return at / start - 1.0;
            }
        }
        return -1.0;
    }
};

} // namespace

TEST_CASE("a strip in tension tears at the threshold for every step length")
{
    // With a Poisson ratio of 0 the stress is the same all along the strip and its cross section stays constant. The
    // force per area is E/2 (s - 1/s) at stretch s.
    const double youngModulus = 10e3, share = kThreshold / youngModulus,
                 expected = share + std::hypot(1.0, share) - 1.0;
    for (double dt : {1e-3, 5e-4}) {
        PulledStrip strip(
            FemMaterial{.youngModulus = youngModulus, .poissonRatio = 0.0, .tearingThreshold = kThreshold}, 0.05,
            {10, 2, 2});
        const double strain = strip.pull(0.1, 0.5, dt);
        INFO("strain " << strain << ", expected " << expected);
        CHECK(std::abs(strain / expected - 1.0) < 0.05);
    }
}

TEST_CASE("a strip that is pulled further tears apart, and both ends go on")
{
    PulledStrip strip(FemMaterial{.youngModulus = 10e3, .poissonRatio = 0.3, .tearingThreshold = kThreshold}, 0.05,
                      {10, 2, 2});
    int detached = 0;
    std::uint32_t flags = 0;
    for (int i = 0; i < 2000 && detached == 0; ++i) {
        strip.at += 0.2 * strip.start * 1e-3;
        strip.stage.post(SetPose{strip.clamp, 0, Pose{.position = {strip.at, 0, 0}}});
        const StepReport report = strip.stage.step(1e-3);
        flags |= report.flags;
        for (const Rupture& rupture : report.topology.ruptures) detached += static_cast<int>(rupture.detached.size());
    }
    CHECK(detached >= 1);
    CHECK(flags == 0);
    strip.stage.run(300, 1e-3);
    check(strip.stage.model(), strip.stage.soft());
}

TEST_CASE("springs under uniform strain have the stress of the force at their ends")
{
    PulledStrip strip(MassSpringMaterial{.stiffness = 50.0, .damping = 0.1}, 0.05, {10, 3, 3});
    strip.pull(0.05, 0.1, 1e-3);
    strip.stage.run(1500, 1e-3);
    const SoftModel& model = strip.stage.model();
    WorkerPool pool(1);
    std::vector<Mat3> stresses;
    findStresses(model, strip.stage.soft(), {1e3, springsOfElements(model)}, pool, stresses);
    // The mean over the volume times the cross section is the force at the ends.
    double pulled = 0.0;
    const std::vector<Vec3>& x = strip.stage.soft().x;
    for (std::size_t e = 0; e < stresses.size(); ++e) {
        const geometry::Tetrahedron& t = model.tetrahedra[e];
        pulled += geometry::signedVolume(x[t[0]], x[t[1]], x[t[2]], x[t[3]]) * stresses[e][0].x;
    }
    const double force = std::abs(strip.stage.world.scene().attachmentReports.at(0).force.x);
    CHECK(pulled / (0.05 * 1.1) == Approx(force).epsilon(0.05));
}

TEST_CASE("a mass-spring strip tears")
{
    PulledStrip strip(MassSpringMaterial{.stiffness = 50.0, .damping = 0.1, .tearingThreshold = kThreshold}, 0.05,
                      {10, 2, 2});
    CHECK(strip.pull(0.2, 1.0, 1e-3) > 0.0);
    strip.stage.run(200, 1e-3);
    check(strip.stage.model(), strip.stage.soft());
}

TEST_CASE("a search limited to elements near the threshold finds bit-identical stresses")
{
    // Slow and fast, with small and large strains, until the strip has torn apart and after that.
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    int looks = 0, skipped = 0, above = 0, tears = 0;
    for (const double poissonRatio : {0.0, 0.3, 0.45})
        for (const double speed : {0.2, 2.0}) {
            PulledStrip strip(
                FemMaterial{.youngModulus = 10e3, .poissonRatio = poissonRatio, .tearingThreshold = kThreshold}, 0.05,
                {10, 3, 3});
            WorkerPool pool(2);
            std::vector<std::uint16_t> stressed;
            std::vector<Mat3> all, some;
            const double dt = speed < 1.0 ? 2e-3 : 1e-3;
            for (int i = 0; i < (speed < 1.0 ? 750 : 300); ++i) {
                strip.at += speed * strip.start * dt;
                strip.stage.post(SetPose{strip.clamp, 0, Pose{.position = {strip.at, 1e-3 * number(random), 0}}});
                tears += static_cast<int>(strip.stage.step(dt).topology.ruptures.size());
                if (i % 4 != 0) continue;
                const SoftModel& model = strip.stage.model();
                const SoftState& state = strip.stage.soft();
                MatrixFreeSystem system(model, dt);
                const bool torn = findStresses(model, state, {kThreshold, {}}, pool, all);
                const bool any = system.findStressed(model, state, kStressNear * kThreshold, pool, stressed);
                const bool found = findStresses(model, state, {kThreshold, {}, stressed}, pool, some);
                REQUIRE(found == torn);
                REQUIRE((any || !torn));
                REQUIRE(some == all);
                for (std::size_t e = 0; e < model.elements.size(); ++e)
                    skipped += (stressed[e / kBlock] >> e % kBlock & 1) == 0 ? 1 : 0;
                looks += static_cast<int>(model.elements.size());
                above += torn ? 1 : 0;
            }
        }
    CHECK(tears > 10);
    CHECK(above > 10);
    CHECK(skipped > looks / 4);
    CHECK(skipped < looks);
}

TEST_CASE("a threshold without dynamicTopology is an error that names body and value")
{
    Stage stage;
    const SoftBodyDef def{.name = "liver",
                          .mesh = shared(boxMesh({1, 1, 1}, {1, 1, 1})),
                          .material = FemMaterial{.tearingThreshold = 5e3}};
    CHECK_THROWS_WITH(stage.add(def), Catch::Contains("liver") && Catch::Contains("tearingThreshold") &&
                                          Catch::Contains("dynamicTopology") && Catch::Contains("5000"));
    SoftBodyDef zero = def;
    zero.dynamicTopology = true;
    zero.material = FemMaterial{.tearingThreshold = 0.0};
    CHECK_THROWS_WITH(stage.add(zero), Catch::Contains("tearingThreshold") && Catch::Contains("> 0"));
}

} // namespace tearing_test
