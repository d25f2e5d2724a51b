#include "filasofia/filasofia.h"

#include "filasofia/runtime/stepped_run.h"

#include <mutex>

namespace ducts_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

/// An artery along x, 30 mm long, and a knife above its middle that goes through it from 0.5 s on.
struct Artery {
    Simulation sim{SimulationDef{.physics = {.rate = 500, .gravity = {}, .threads = 1}}};
    BodyId artery, knife;
    std::array<BodyId, 2> clips = {};
    bool away = false; ///< the knife stays above
    std::mutex mutex;
    std::vector<DuctBalance> told;

    explicit Artery(bool bleeds = false)
    {
        std::vector<Vec3> line;
        for (int i = 0; i <= 30; ++i) line.push_back({1_mm * i - 15_mm, 0, 0});
        SoftBodyDef def{.name = "artery", .mesh = shapes::vessel(line, 1_mm, 0.8_mm, {8, 1})};
        def.material = FemMaterial{.youngModulus = 40_kPa, .poissonRatio = 0.4};
        def.attachments = {{.box = Box{{-1, -1, -1}, {-14.5_mm, 1, 1}}}, {.box = Box{{14.5_mm, -1, -1}, {1, 1, 1}}}};
        def.dynamicTopology = true;
        artery = sim.add(def);
        if (bleeds) sim.bleed(artery, {.flux = 1e-3});
        for (const int i : {0, 1}) {
            RigidBodyDef clip{.name = text("clip ", i), .elements = {{{(i == 0 ? -7_mm : 7_mm), 0, 0}}}};
            clip.mesh = shapes::box({1_mm, 1_mm, 8_mm});
            clip.dynamic = true;
            clip.mass = TotalMass{1e-4};
            clips[static_cast<std::size_t>(i)] = sim.add(clip);
        }
        const Quat across = axisAngle({0, 0, 1}, 90_deg);
        RigidBodyDef blade{.name = "knife", .elements = {{{0.3_mm, 20_mm, 0}, across}}};
        blade.collision = {{.mesh = shapes::sheet(10_mm, 10_mm, {1, 1}), .cutting = true}};
        knife = sim.add(blade);
        sim.everyStep([this, across](double time) {
            const double down = (away ? 0.0 : std::clamp(time - 0.5, 0.0, 0.4)) * 60_mm;
            sim.physics().setPose(knife, {{0.3_mm, 20_mm - down, 0}, across});
        });
        sim.addDuct(artery, {.name = "cystic artery",
                             .path = {line.front(), line.back()},
                             .radius = 1_mm,
                             .viscosity = 3.5e-3,
                             .inletPressure = 12e3,
                             .outletPressure = 2e3,
                             .inletResistance = kFeed,
                             .outletResistance = 4 * kFeed});
        sim.on<DuctEvent>([this](const DuctEvent& e) {
            const std::lock_guard lock(mutex);
            CHECK(e.body == artery);
            told.push_back(e.balance);
        });
    }
    static constexpr double kFeed = 2e10; ///< [Pa s/m^3]
    RunReport run(int steps) { return sim.run({.headless = true, .backend = Backend::Null, .steps = steps}); }
};

} // namespace

TEST_CASE("a duct that is cut without a clip leaks, is told, and is in the summary")
{
    Artery it;
    static_cast<void>(it.run(200));
    const double whole = 8.0 * 3.5e-3 * 30_mm / (3.14159265 * std::pow(1_mm, 4));
    CHECK(it.sim.duct(it.artery).flow == Approx(10e3 / (whole + 5 * it.kFeed)).epsilon(0.05));
    const RunReport report = it.run(400);
    const DuctBalance now = it.sim.duct(it.artery);
    CHECK(now.state == DuctState::Leaking);
    CHECK(now.leak == Approx(12e3 / it.kFeed + 2e3 / (4 * it.kFeed)).epsilon(0.05)); // the tube itself resists little
    CHECK(now.lost > 0.0);
    REQUIRE(report.ducts.size() == 1);
    CHECK(report.ducts[0].duct == "cystic artery");
    CHECK(summary(report).find("duct 'cystic artery' of 'artery': leaking; clips 0 + 0") != std::string::npos);
    const std::lock_guard lock(it.mutex);
    REQUIRE(it.told.size() >= 2);
    CHECK(it.told.front().state == DuctState::Open);
    CHECK(it.told.back().state == DuctState::Leaking);
}

TEST_CASE("a duct that is clipped on both sides and cut between loses nothing, and its ends do not bleed")
{
    double welled[2] = {};
    for (const bool clipped : {false, true}) {
        Artery it(true);
        if (clipped)
            for (const BodyId clip : it.clips) it.sim.physics().clip(clip, it.artery, {.opening = 8_mm});
        static_cast<void>(it.run(240));
        if (clipped) {
            CHECK(it.sim.duct(it.artery).state == DuctState::Clipped);
            CHECK(it.sim.duct(it.artery).clipsBefore == 2);
            CHECK(it.sim.duct(it.artery).flow == 0.0);
        }
        const RunReport report = it.run(1000);
        const DuctBalance now = it.sim.duct(it.artery);
        // One number: what has flowed out of the ends is on the body's film, but for the last 50 ms.
        if (!clipped) CHECK(it.sim.blood(it.artery).welled == Approx(now.lost).epsilon(0.05));
        CHECK(now.state == (clipped ? DuctState::Cut : DuctState::Leaking));
        CHECK((now.leak > 0.0) == !clipped);
        CHECK(report.clips.applied == 0); // it was in the first run
        welled[clipped] = it.sim.blood(it.artery).welled;
        CHECK((it.sim.blood(it.artery).rate > 0.0) == !clipped);
        if (!clipped) continue;
        CHECK(now.clipsBefore == 1);
        CHECK(now.clipsAfter == 1);
        CHECK(now.lost == 0.0);
    }
    CHECK(welled[0] > 1e-9);
    CHECK(welled[1] < 0.1 * welled[0]); // until it was sealed
}

TEST_CASE("a saved state has ducts and clips, and a reset makes both whole")
{
    Artery it;
    it.sim.physics().clip(it.clips[0], it.artery, {.opening = 8_mm});
    SteppedRun run(it.sim, RunDef{.backend = Backend::Null});
    for (int i = 0; i < 300; ++i) run.step();
    const auto saved = run.save();
    const auto finish = [&] {
        for (int i = 0; i < 300; ++i) run.step();
        return std::pair(it.sim.duct(it.artery), it.sim.physics().hash());
    };
    const auto first = finish();
    CHECK(first.first.lost > 0.0);
    run.restore(*saved);
    CHECK(finish() == first);
    it.away = true;
    it.sim.reset(); // the duct is whole from here on, and what is told begins with that
    {
        const std::lock_guard lock(it.mutex);
        it.told.clear();
    }
    CHECK(it.sim.duct(it.artery).state == DuctState::Open);
    for (int i = 0; i < 3; ++i) run.step();
    {
        const std::lock_guard lock(it.mutex);
        REQUIRE(!it.told.empty());
        for (const DuctBalance& each : it.told) CHECK(each.state == DuctState::Open);
    }
    CHECK(it.sim.duct(it.artery).state == DuctState::Open);
    CHECK(it.sim.duct(it.artery).lost == 0.0);
    CHECK(it.sim.duct(it.artery).clipsBefore == 0);
}

TEST_CASE("a duct leaves with its body")
{
    Artery it;
    static_cast<void>(it.run(50));
    it.sim.physics().remove(it.artery);
    const RunReport report = it.run(5);
    CHECK(report.ducts.empty());
    CHECK_THROWS_WITH(static_cast<void>(it.sim.duct(it.artery)),
                      text("duct: body ", it.artery.value, " has none; addDuct() makes one"));
}

TEST_CASE("a clip that is closed, closed on nothing, or pulled off is an event")
{
    Artery it;
    it.away = true;
    std::vector<physics::ClipChange> changes;
    it.sim.on<ClipEvent>([&](const ClipEvent& e) {
        const std::lock_guard lock(it.mutex);
        changes.push_back(e.change);
    });
    const AttachmentId hold = it.sim.physics().clip(it.clips[0], it.artery, {.opening = 8_mm, .friction = 0.01});
    it.sim.physics().setPose(it.clips[1], {{0, 0.2, 0}, {}});
    it.sim.physics().clip(it.clips[1], it.artery);
    static_cast<void>(it.run(300));
    it.sim.physics().setWrench(it.clips[0], {0, 0, 0.5}, {});
    const RunReport report = it.run(300);
    CHECK(report.clips.slipped == 1);
    const std::lock_guard lock(it.mutex);
    using enum physics::ClipChange::Kind;
    REQUIRE(changes.size() == 3);
    CHECK(changes[0].kind == Applied);
    CHECK(changes[0].id == hold);
    CHECK(changes[1].kind == Missed);
    CHECK(changes[1].clip == it.clips[1]);
    CHECK(changes[2].kind == Slipped);
    CHECK(changes[2].tissue == it.artery);
}

TEST_CASE("what has no duct is one clear Error")
{
    Artery it;
    const auto problem = [](const auto& act) -> std::string {
        try {
            act();
        } catch (const Error& error) {
            return error.what();
        }
        return "none";
    };
    CHECK(problem([&] { it.sim.addDuct(it.knife, {}); }) ==
          "duct 'duct' of rigid body 'knife': needs a soft body of tetrahedra");
    CHECK(problem([&] {
              it.sim.addDuct(it.artery, {.radius = 0.0});
          }).starts_with("duct 'duct' of soft body 'artery': radius must be in [1e-05, 0.1]"));
    CHECK(problem([&] { static_cast<void>(it.sim.duct(it.knife)); }) ==
          text("duct: body ", it.knife.value, " has none; addDuct() makes one"));
    CHECK(problem([&] { static_cast<void>(it.sim.duct(it.artery, 2)); }) ==
          text("duct of body ", it.artery.value, ": duct must be in [0, 1), got 2"));
}

} // namespace ducts_test
