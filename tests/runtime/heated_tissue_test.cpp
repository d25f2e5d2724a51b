#include "filasofia/filasofia.h"

#include "filasofia/runtime/replay.h"
#include "filasofia/runtime/stepped_run.h"
#include "runtime/cut_block.h"
#include "skip.h"

#include <filesystem>

#include <unistd.h>

namespace heated_tissue_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// A strip of 60 x 2 x 4 mm along x without weight, held at x = -30 mm. Its layer is as deep as it is thick.
struct Strip {
    Simulation sim;
    BodyId tissue;
    explicit Strip(const std::optional<HeatedTissueDef>& heated, int threads = 1, double threshold = physics::kNever)
        : sim(SimulationDef{.physics = {.rate = 500, .gravity = {}, .threads = threads}})
    {
        SoftBodyDef def{.name = "strip", .mesh = shapes::block({60_mm, 2_mm, 4_mm}, {30, 1, 2})};
        def.material = FemMaterial{.youngModulus = 100_kPa, .poissonRatio = 0.3, .tearingThreshold = threshold};
        def.rayleigh = {.mass = 20.0};
        def.attachments = {{.box = Box{{-1, -1, -1}, {-29.9_mm, 1, 1}}}};
        def.dynamicTopology = std::isfinite(threshold);
        tissue = sim.add(def);
        sim.burn(tissue, {.conductivity = 0.0, .perfusion = 0.0, .loss = 0.0, .tissue = heated});
    }
    /// Within some mm of a place, to a temperature at which all of it is denatured within the time.
    void heat(double radius) { sim.treat(tissue, Heat{.radius = radius, .power = 400.0, .limit = 363.15}); }
    /// [m], the middle of the nodes that were at this x.
    Vec3 at(double x)
    {
        const auto frame = sim.physics().latest();
        Vec3 sum;
        int count = 0;
        const auto mesh =
            std::get<std::shared_ptr<const TetMesh>>(std::get<SoftBodyDef>(*sim.physics().def(tissue)).mesh);
        for (std::size_t i = 0; i < mesh->nodes.size(); ++i)
            if (std::abs(mesh->nodes[i].x - x) < 0.1_mm) sum += frame->softBody(tissue)->positions[i], ++count;
        return 1.0 / count * sum;
    }
    double end() { return at(30_mm).x; }
    /// [m], along its middle, from where it was at -20 mm to its end: where it is held it cannot shrink sideways.
    double length()
    {
        double sum = 0.0;
        for (int i = -10; i < 15; ++i) sum += distance(at(i * 2_mm), at((i + 1) * 2_mm));
        return sum;
    }
};

/// [N], with which an end of the strip is pulled when it tears.
double tearingForce(const std::optional<HeatedTissueDef>& heated)
{
    Strip strip(heated, 1, 10_kPa);
    strip.heat(1.0);
    double force = 0.0, torn = 0.0;
    strip.sim.everyStep([&](double time) {
        force = 0.03 * std::max(time - 2.0, 0.0);
        std::vector<NodalForce> forces;
        const auto mesh = std::get<std::shared_ptr<const TetMesh>>(
            std::get<SoftBodyDef>(*strip.sim.physics().def(strip.tissue)).mesh);
        // In a row of nodes those in its middle carry twice as much as those at its ends.
        for (std::size_t i = 0; i < mesh->nodes.size(); ++i)
            if (mesh->nodes[i].x > 29.9_mm)
                forces.push_back(
                    {static_cast<int>(i), {force * (std::abs(mesh->nodes[i].z) < 1_mm ? 0.25 : 0.125), 0, 0}});
        strip.sim.physics().setForces(strip.tissue, forces);
    });
    SteppedRun run(strip.sim);
    for (int i = 0; i < 3000 && torn == 0.0; ++i)
        if (!run.step().topology.ruptures.empty()) torn = force;
    return torn;
}

/// A cut block whose upper side a source heats, as its recording.
struct HotBlock : CutBlock {
    explicit HotBlock(int threads = 1, bool acts = true) : CutBlock(threads, {16, 4, 12})
    {
        sim.burn(tissue, {.tissue = acts ? std::optional(HeatedTissueDef{}) : std::nullopt});
        sim.treat(tissue, Heat{.place = {0, 6_mm, 0}, .radius = 5_mm, .power = 60.0});
    }
};

} // namespace

TEST_CASE("a strip that is burnt over its middle shortens by the told part of what is burnt")
{
    for (const double shrinkage : {0.1, 0.3}) {
        // It changes once the source is off, into which it would draw more and more.
        Strip strip(HeatedTissueDef{.shrinkage = shrinkage, .rate = 1.0});
        strip.heat(10_mm);
        strip.sim.run({.headless = true, .steps = 250});
        strip.sim.treat(strip.tissue, Heat{});
        strip.sim.run({.headless = true, .steps = 1500});
        const double shorter = 50_mm - strip.length();
        INFO("shrinkage " << shrinkage << ", shorter by " << shorter);
        // The share falls to zero over the next 2 mm of the mesh at either side.
        CHECK(shorter == Approx(shrinkage * 22_mm).epsilon(0.05));
    }
}

TEST_CASE("a strip that is burnt all over is shorter by the told part, and one that only stiffens is not")
{
    Strip all(HeatedTissueDef{.shrinkage = 0.2}), stiff(HeatedTissueDef{.shrinkage = 0.0}), none(std::nullopt);
    for (Strip* each : {&all, &stiff, &none}) {
        each->heat(1.0);
        each->sim.run({.headless = true, .steps = 3000});
    }
    CHECK(all.length() == Approx(0.8 * 50_mm).epsilon(0.005));
    CHECK(std::abs(30_mm - stiff.end()) < 1e-6);
    CHECK(std::abs(30_mm - none.end()) < 1e-8);
}

TEST_CASE("heated tissue tears at the told part of the force")
{
    const double before = tearingForce(std::nullopt);
    CHECK(before > 0.02);
    const auto relative = [&](double strength) {
        return tearingForce(HeatedTissueDef{.shrinkage = 0.0, .stiffness = 1.0, .strength = strength}) / before;
    };
    CHECK(relative(0.5) == Approx(0.5).epsilon(0.05));
    CHECK(relative(0.25) == Approx(0.25).epsilon(0.05));
}

TEST_CASE("heated tissue is as stiff as told")
{
    const auto stretch = [](const std::optional<HeatedTissueDef>& heated) {
        Strip strip(heated);
        strip.heat(1.0);
        strip.sim.run({.headless = true, .steps = 1000});
        std::vector<NodalForce> forces;
        const auto mesh = std::get<std::shared_ptr<const TetMesh>>(
            std::get<SoftBodyDef>(*strip.sim.physics().def(strip.tissue)).mesh);
        for (std::size_t i = 0; i < mesh->nodes.size(); ++i)
            if (mesh->nodes[i].x > 29.9_mm) forces.push_back({static_cast<int>(i), {1e-3, 0, 0}});
        strip.sim.physics().setForces(strip.tissue, forces);
        const double before = strip.end();
        strip.sim.run({.headless = true, .steps = 2000});
        return strip.end() - before;
    };
    const double soft = stretch(std::nullopt);
    CHECK(soft > 1e-4);
    CHECK(soft / stretch(HeatedTissueDef{.shrinkage = 0.0, .stiffness = 4.0}) == Approx(4.0).epsilon(0.03));
}

TEST_CASE("heat that acts on tissue has the same bits for any number of threads, and without it a run is as a cold one")
{
    const auto hash = [](int threads, bool acts) {
        HotBlock block(threads, acts);
        return block.sim.run({.headless = true, .steps = 600}).hash;
    };
    CutBlock cold(1, {16, 4, 12});
    const std::uint64_t unheated = cold.sim.run({.headless = true, .steps = 600}).hash;
    CHECK(hash(1, false) == unheated);
    const std::uint64_t heated = hash(1, true);
    CHECK(heated != unheated);
    CHECK(hash(3, true) == heated);
}

TEST_CASE("a replay of heated tissue has the hash of every step, also if it draws the heat")
{
    const auto folder = std::filesystem::temp_directory_path() / text("filasofia_heated_tissue_test_", getpid());
    std::filesystem::create_directory(folder);
    const std::string file = folder / "run.rec";
    HotBlock block;
    block.sim.show(block.tissue);
    const RunReport report = block.sim.run({.headless = true, .steps = 500, .record = file});
    const ReplayReport again = replay({.file = file, .check = true, .threads = 2});
    CHECK_FALSE(again.difference);
    CHECK(again.unhashed == 0);
    CHECK(again.hash == report.hash);
    if (visual::hasBackend(Backend::Headless)) {
        const ReplayReport drawn = replay({.file = file, .check = true, .picture = folder / "again.png"});
        CHECK_FALSE(drawn.difference);
        CHECK(drawn.hash == report.hash);
    }
    std::filesystem::remove_all(folder);
}

TEST_CASE("a reset heals heated tissue, and a restored state goes on as it did")
{
    HotBlock block;
    SteppedRun run(block.sim);
    for (int i = 0; i < 200; ++i) run.step();
    const auto saved = run.save();
    const auto go = [&] {
        for (int i = 0; i < 150; ++i) run.step();
        return block.sim.physics().hash();
    };
    const std::uint64_t first = go();
    run.restore(*saved);
    CHECK(go() == first);

    Strip strip(HeatedTissueDef{});
    SteppedRun steps(strip.sim);
    strip.heat(1.0);
    for (int i = 0; i < 1000; ++i) steps.step();
    CHECK(strip.end() < 20_mm);
    strip.sim.reset();
    for (int i = 0; i < 500; ++i) steps.step();
    CHECK(std::abs(strip.end() - 30_mm) < 1e-8);
}

TEST_CASE("wrong use of heat on tissue is one clear error")
{
    CutBlock block(1, {16, 4, 12});
    CHECK_THROWS_WITH(block.sim.burn(block.tissue, {.tissue = HeatedTissueDef{.shrinkage = 0.6}}),
                      "burning of soft body 'tissue': tissue.shrinkage must be in [0, 0.5], got 0.6");
    CHECK_THROWS_WITH(block.sim.burn(block.tissue, {.tissue = HeatedTissueDef{.rate = 0.5}}),
                      "burning of soft body 'tissue': tissue.rate must be in [1, 1000] 1/s, got 0.5");
    SoftBodyDef net{.name = "net", .mesh = shapes::block({10_mm, 10_mm, 10_mm}, {2, 2, 2})};
    net.material = MassSpringMaterial{};
    CHECK_THROWS_WITH(block.sim.burn(block.sim.add(net), {.tissue = HeatedTissueDef{}}),
                      "burning of soft body 'net': tissue needs a body with a FemMaterial");
}

} // namespace heated_tissue_test
