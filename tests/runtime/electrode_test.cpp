#include "filasofia/filasofia.h"

#include "filasofia/runtime/replay.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/visual/image.h"
#include "shown_stage.h"
#include "skip.h"

#include <filesystem>
#include <functional>

#include <unistd.h>

namespace electrode_test {

using namespace filasofia;
using namespace filasofia::runtime;

namespace {

constexpr double kStep = 1.0 / 500;
const Quat kUpright = axisAngle({1, 0, 0}, 90_deg);

/// A block whose lower side is held, and a hook whose blade hangs 10 mm below its origin; its tip is the lower
/// end of the blade.
struct Theatre {
    Simulation sim;
    BodyId tissue, hook;
    std::function<Vec3(double)> place = [](double) { return Vec3{0, 40_mm, 0}; };

    explicit Theatre(int threads = 1, const BurningDef& burning = {.rate = 50})
        : sim(SimulationDef{.physics = {.rate = 500, .threads = threads}})
    {
        tissue = add("tissue", 0.0, burning);
        RigidBodyDef blade{.name = "hook", .elements = {{{0, 40_mm, 0}, kUpright}}};
        blade.collision = {{.mesh = shapes::sheet(6_mm, 20_mm, {1, 1}), .cutting = true}};
        hook = sim.add(blade);
        sim.everyStep([this](double time) { sim.physics().setPose(hook, {place(time), kUpright}); });
    }
    BodyId add(const std::string& name, double x, const BurningDef& burning, bool stiff = false)
    {
        SoftBodyDef def{
            .name = name, .mesh = shapes::block({40_mm, 12_mm, 30_mm}, {16, 4, 12}), .dynamicTopology = true};
        def.pose.position = {x, 0, 0};
        def.attachments = {{.box = Box{{-1, -1, -1}, {1, stiff ? 1.0 : -5.9_mm, 1}}}};
        const BodyId id = sim.add(def);
        sim.burn(id, burning);
        return id;
    }
    /// From above into the tissue within 0.1 s, and along it.
    static Vec3 through(double time)
    {
        return {-12_mm + 40_mm * std::clamp(time - 0.1, 0.0, 0.6), 30_mm - 20_mm * std::min(time / 0.1, 1.0), 0};
    }
    [[nodiscard]] static ElectrodeDef at(EnergyMode mode, double power, double radius = 2_mm)
    {
        return {.mode = mode, .power = power, .radius = radius, .tip = {.from = {0, 0, 10_mm}, .to = {0, 0, 4_mm}}};
    }
    RunReport run(int steps) { return sim.run({.headless = true, .steps = steps}); }
};

/// A theatre in which the tip touches the tissue, which keeps its shape, from (0, 6 mm, 0) on.
struct StillTheatre {
    Simulation sim{SimulationDef{.physics = {.rate = 500, .threads = 1}}};
    BodyId tissue, stick;
    explicit StillTheatre(const ElectrodeDef& def, const BurningDef& burning = {.rate = 50})
    {
        tissue = add("tissue", 0.0, burning);
        stick = sim.add(RigidBodyDef{.name = "stick", .elements = {{{0, 6_mm, 0}}, {{0, 6_mm, 5_mm}}}});
        sim.addElectrode(stick, def);
    }
    BodyId add(const std::string& name, double x, const BurningDef& burning)
    {
        SoftBodyDef def{.name = name, .mesh = shapes::block({40_mm, 12_mm, 30_mm}, {16, 4, 12})};
        def.pose.position = {x, 0, 0};
        def.attachments = {{.box = Box{{-1, -1, -1}, {1, 1, 1}}}};
        const BodyId id = sim.add(def);
        sim.burn(id, burning);
        return id;
    }
    RunReport run(int steps) { return sim.run({.headless = true, .steps = steps}); }
};

double error(const HeatBalance& b) { return b.delivered - b.stored - b.perfused - b.lost - b.boiled - b.carriedOff; }

const ElectrodeDef kWeak{.mode = EnergyMode::Coagulate, .power = 2.0, .radius = 3_mm, .limit = 1e4};

} // namespace

TEST_CASE("an electrode that is held still heats as a source of the same power does")
{
    StillTheatre one(kWeak), other(kWeak);
    one.run(10); // to the end of a step of the heat
    other.run(10);
    one.sim.activate(one.stick, true);
    other.sim.treat(other.tissue, Heat{.place = {0, 6_mm, 0}, .radius = 3_mm, .power = 2.0, .limit = 1e4});
    const HeatBalance a = one.run(1000).heat.at(0).balance, b = other.run(1000).heat.at(0).balance;
    CHECK(a.delivered == Approx(2.0 * 2.0).epsilon(1e-9));
    CHECK(a.delivered == Approx(b.delivered).epsilon(1e-12));
    CHECK(a.peak - 310.15 == Approx(b.peak - 310.15).epsilon(1e-9));
    CHECK(a.burnt == b.burnt);
    CHECK(std::abs(error(a)) < 1e-9 * a.delivered);
}

TEST_CASE("a mesh that is too coarse for what an electrode burns is told once, with its lengths, and a fine one is not")
{
    for (const bool coarse : {true, false}) {
        std::vector<std::string> warned;
        setLogSink([&](LogLevel level, std::string_view line) {
            if (level == LogLevel::Warning) warned.emplace_back(line);
        });
        Simulation sim{SimulationDef{.physics = {.rate = 500, .threads = 1}}};
        SoftBodyDef def{.name = "liver",
                        .mesh = shapes::block({48_mm, 6_mm, 48_mm}, {coarse ? 4 : 16, 1, coarse ? 4 : 16})};
        def.attachments = {{.box = Box{{-1, -1, -1}, {1, 1, 1}}}};
        sim.burn(sim.add(def), {.rate = 50});
        const BodyId stick = sim.add(RigidBodyDef{.name = "stick", .elements = {{{0, 3_mm, 0}}}});
        for (const double power : {30.0, 10.0})
            sim.addElectrode(stick, {.mode = EnergyMode::Coagulate, .power = power, .radius = 4_mm});
        for (const int electrode : {0, 1}) sim.activate(stick, true, electrode);
        sim.run({.headless = true, .steps = 100});
        setLogSink({});
        REQUIRE(warned.size() == (coarse ? 1 : 0));
        if (!coarse) continue;
        for (const char* said : {"rigid body 'stick'", "soft body 'liver'", "13.7 mm long", "reaches 4 mm",
                                 "spreads 1.8 mm", "edges of at most 4 mm"})
            CHECK_THAT(warned[0], Catch::Contains(said));
    }
}

TEST_CASE("a coarse mesh that loses no heat is told, with how far heat spreads in a minute")
{
    std::vector<std::string> warned;
    setLogSink([&](LogLevel level, std::string_view line) {
        if (level == LogLevel::Warning) warned.emplace_back(line);
    });
    for (const double perfusion : {0.0, 1e-9}) {
        Simulation sim{SimulationDef{.physics = {.rate = 500, .threads = 1}}};
        SoftBodyDef def{.name = "liver", .mesh = shapes::block({48_mm, 6_mm, 48_mm}, {4, 1, 4})};
        def.attachments = {{.box = Box{{-1, -1, -1}, {1, 1, 1}}}};
        sim.burn(sim.add(def), {.perfusion = perfusion, .loss = 0.0, .rate = 50});
        const BodyId stick = sim.add(RigidBodyDef{.name = "stick", .elements = {{{0, 3_mm, 0}}}});
        sim.addElectrode(stick, {.mode = EnergyMode::Coagulate, .power = 10.0, .radius = 2_mm});
        sim.activate(stick, true);
        sim.run({.headless = true, .steps = 100});
    }
    setLogSink({});
    REQUIRE(warned.size() == 2);
    for (const std::string& line : warned) // sqrt(0.52 * 60 / (1060 * 3540)) m
        CHECK_THAT(line, Catch::Contains("spreads 2.9 mm") && Catch::Contains("edges of at most 2.9 mm"));
}

TEST_CASE("a tip that moves gives its power for the time with its pedal pressed and in contact, exactly")
{
    StillTheatre theatre(kWeak);
    int pressed = 0;
    theatre.sim.everyStep([&](double time) {
        const int step = static_cast<int>(std::lround(time / kStep));
        const bool away = step > 500 && step <= 700; // a step of the heat ends at each tenth
        theatre.sim.physics().setPose(theatre.stick, {{-10_mm + 15_mm * time, away ? 20_mm : 6_mm, 0}});
        const bool on = step <= 900 && (step / 7) % 3 != 0; // pressed two times in three, at odd times
        theatre.sim.activate(theatre.stick, on);
        pressed += on ? 1 : 0;
    });
    const RunReport report = theatre.run(1000);
    const EnergyBalance energy = report.energy.at(0).balance;
    CHECK(energy.active == Approx(pressed * kStep).epsilon(1e-12));
    int inAir = 0;
    for (int step = 501; step <= 700; ++step) inAir += (step / 7) % 3 != 0 ? 1 : 0;
    CHECK(energy.inAir == Approx(inAir * kStep).epsilon(1e-12));
    CHECK(energy.delivered == Approx(2.0 * (pressed - inAir) * kStep).epsilon(1e-9));
    CHECK(report.heat.at(0).balance.delivered == Approx(energy.delivered).epsilon(1e-12));
    CHECK(std::abs(error(report.heat.at(0).balance)) < 1e-9 * energy.delivered);
    CHECK_THAT(summary(report), Catch::Contains("energy of 'stick' (coagulate): 2 J in 1.") &&
                                    Catch::Contains(" s of activation, 0.26 s of them in air"));
}

TEST_CASE("a bent tip heats where any part of it touches")
{
    ElectrodeDef def = kWeak;
    def.tip = {.from = {-2_mm, 20_mm, 0}, .to = {2_mm, 20_mm, 0}}; // above the tissue
    const auto after = [&] {
        StillTheatre theatre(def);
        theatre.sim.activate(theatre.stick, true);
        return theatre.run(500).energy.at(0).balance;
    };
    CHECK(after().delivered == 0.0);
    def.tip.through = {{-2_mm, 0, 0}, {2_mm, 0, 0}}; // a U
    const EnergyBalance energy = after();
    CHECK(energy.inAir == 0.0);
    CHECK(energy.delivered == Approx(2.0).epsilon(1e-9));
}

TEST_CASE("without anything that burns an active electrode is in air")
{
    Simulation sim;
    const BodyId stick = sim.add(RigidBodyDef{.name = "stick"});
    sim.addElectrode(stick, kWeak);
    sim.activate(stick, true);
    const EnergyBalance energy = sim.run({.headless = true, .steps = 100}).energy.at(0).balance;
    CHECK(energy.active == Approx(0.1));
    CHECK(energy.inAir == energy.active);
    CHECK(energy.delivered == 0.0);
}

TEST_CASE("a cold hook does not cut, an active one does, and one that coagulates only heats")
{
    struct Went {
        double cut = 0.0, burnt = 0.0, delivered = 0.0;
    };
    const auto go = [](std::optional<int> pressed) {
        Theatre theatre;
        theatre.place = Theatre::through;
        CHECK(theatre.sim.addElectrode(theatre.hook, Theatre::at(EnergyMode::Cut, 60.0)) == 0);
        CHECK(theatre.sim.addElectrode(theatre.hook, Theatre::at(EnergyMode::Coagulate, 30.0)) == 1);
        if (pressed) theatre.sim.activate(theatre.hook, true, *pressed);
        const RunReport report = theatre.run(400);
        return Went{report.cutArea(), report.heat.at(0).balance.burnt, report.heat.at(0).balance.delivered};
    };
    const Went cold = go({}), cut = go(0), coagulated = go(1);
    CHECK(cold.cut == 0.0);
    CHECK(cold.delivered == 0.0);
    CHECK(cut.cut > 20e-6);
    CHECK(cut.burnt > 5e-6);
    CHECK(coagulated.cut == 0.0);
    CHECK(coagulated.burnt > 5e-6);
}

TEST_CASE("energy has the same bits for any number of threads, and heat does not act on physics")
{
    const auto go = [](int threads, double power) {
        Theatre theatre(threads);
        theatre.place = Theatre::through;
        theatre.sim.addElectrode(theatre.hook, Theatre::at(EnergyMode::Cut, power));
        theatre.sim.activate(theatre.hook, true);
        return theatre.run(300);
    };
    const RunReport one = go(1, 60.0), three = go(3, 60.0), weak = go(1, 1.0);
    CHECK(one.energy.at(0).balance == three.energy.at(0).balance);
    CHECK(one.heat.at(0).balance == three.heat.at(0).balance);
    CHECK(one.hash == three.hash);
    CHECK(one.hash == weak.hash);
    CHECK(one.heat.at(0).balance.burnt > weak.heat.at(0).balance.burnt);
}

TEST_CASE("a bipolar electrode heats between its jaws, and only while both touch tissue")
{
    const ElectrodeDef def{.mode = EnergyMode::Bipolar,
                           .power = 2.0,
                           .radius = 1.5_mm,
                           .limit = 1e4,
                           .tip = {.element = 0, .from = {-2_mm, 0, 0}, .to = {2_mm, 0, 0}},
                           .other = ElectrodeTip{.element = 1, .from = {2_mm, 0, 0}, .to = {-2_mm, 0, 0}}};
    StillTheatre theatre(def);
    theatre.sim.everyStep([&](double time) { // the second jaw lifts off
        theatre.sim.physics().setPose(theatre.stick, {{0, time > 1.0 + 0.5 * kStep ? 20_mm : 6_mm, 5_mm}}, 1);
    });
    theatre.sim.activate(theatre.stick, true);
    const RunReport report = theatre.run(750);
    const EnergyBalance energy = report.energy.at(0).balance;
    CHECK(energy.active == Approx(1.5));
    CHECK(energy.inAir == Approx(0.5));
    CHECK(energy.delivered == Approx(2.0).epsilon(1e-9));

    // What lies between the jaws shares the power, so it becomes less hot than under a single tip.
    const auto peakOf = [](const ElectrodeDef& each) {
        StillTheatre place(each);
        place.sim.activate(place.stick, true);
        return place.run(250).heat.at(0).balance.peak;
    };
    ElectrodeDef wide = def;
    wide.mode = EnergyMode::Coagulate;
    wide.other.reset();
    CHECK(peakOf(def) - 310.15 < 0.7 * (peakOf(wide) - 310.15));
}

TEST_CASE("bipolar forceps stop what bleeds between their jaws")
{
    const ElectrodeDef forceps{.mode = EnergyMode::Bipolar,
                               .power = 15.0,
                               .radius = 1.5_mm,
                               .limit = 373.15,
                               .tip = {.element = 0, .from = {-2_mm, 0, 0}, .to = {2_mm, 0, 0}},
                               .other = ElectrodeTip{.element = 1, .from = {2_mm, 0, 0}, .to = {-2_mm, 0, 0}}};
    const auto wellsInTheLastSecond = [&](bool pressed) {
        StillTheatre theatre(forceps);
        theatre.sim.bleed(theatre.tissue, {.vesselDensity = std::numeric_limits<double>::infinity()});
        theatre.sim.treat(theatre.tissue, Injure{.place = {0, 6_mm, 2.5_mm}, .radius = 2_mm});
        theatre.run(100);
        theatre.sim.activate(theatre.stick, pressed);
        const double before = theatre.run(1500).blood.at(0).balance.welled;
        CHECK(before > 0.0);
        return theatre.run(500).blood.at(0).balance.welled - before;
    };
    const double bleeding = wellsInTheLastSecond(false);
    CHECK(bleeding > 0.0);
    CHECK(wellsInTheLastSecond(true) == 0.0);
}

TEST_CASE("bodies that one electrode touches divide its power by the area touched, and an injury is told")
{
    StillTheatre theatre({.mode = EnergyMode::Coagulate, .power = 40.0, .radius = 4_mm, .limit = 1e4});
    const BodyId neighbour = theatre.add("bowel", 41_mm, {.target = false, .rate = 50});
    theatre.sim.physics().setPose(theatre.stick, {{20.5_mm, 6_mm, 0}}); // above the gap between them
    std::vector<BurnEvent> burns;
    std::vector<EnergyEvent> told;
    theatre.sim.on<BurnEvent>([&](const BurnEvent& each) { burns.push_back(each); });
    theatre.sim.on<EnergyEvent>([&](const EnergyEvent& each) { told.push_back(each); });
    theatre.sim.activate(theatre.stick, true);
    const RunReport report = theatre.run(1010);
    const double a = report.heat.at(0).balance.delivered, b = report.heat.at(1).balance.delivered;
    CHECK(a == Approx(b).epsilon(0.02));
    CHECK(a + b == Approx(40.0 * 2.02).epsilon(1e-9));
    CHECK(report.energy.at(0).balance.delivered == Approx(a + b).epsilon(1e-12));
    CHECK(report.energy.at(0).balance.inAir == 0.0);
    CHECK(std::ranges::any_of(burns, [&](const BurnEvent& e) { return e.body == neighbour && e.injury && !e.target; }));
    REQUIRE(told.size() >= 3);
    CHECK(told.front().active);
    CHECK(told.front().body == theatre.stick);
    CHECK(told.back().balance.active == Approx(2.0).margin(0.01));
}

TEST_CASE("heat steps of different rates get the same energy in all")
{
    StillTheatre theatre({.mode = EnergyMode::Coagulate, .power = 40.0, .radius = 4_mm, .limit = 1e4});
    theatre.add("bowel", 41_mm, {.rate = 125});
    theatre.sim.physics().setPose(theatre.stick, {{20.5_mm, 6_mm, 0}});
    int pressed = 0;
    theatre.sim.everyStep([&](double time) {
        const bool on = time > 0.1 && time < 0.5;
        theatre.sim.activate(theatre.stick, on);
        pressed += on ? 1 : 0;
    });
    const EnergyBalance energy = theatre.run(400).energy.at(0).balance;
    CHECK(energy.delivered == Approx(40.0 * pressed * kStep).epsilon(1e-9));
    CHECK(energy.inAir == 0.0);
}

TEST_CASE("a body that begins to burn late gets no energy of the time before")
{
    StillTheatre theatre(kWeak);
    theatre.sim.physics().setPose(theatre.stick, {{60_mm, 6_mm, 0}});
    SoftBodyDef def{.name = "late", .mesh = shapes::block({40_mm, 12_mm, 30_mm}, {16, 4, 12})};
    def.pose.position = {60_mm, 0, 0};
    def.attachments = {{.box = Box{{-1, -1, -1}, {1, 1, 1}}}};
    const BodyId late = theatre.sim.add(def);
    theatre.sim.activate(theatre.stick, true);
    theatre.run(500);
    theatre.sim.burn(late, {.rate = 50});
    const RunReport report = theatre.run(500);
    CHECK(report.heat.at(1).balance.delivered == Approx(2.0).epsilon(0.03));
    CHECK(report.energy.at(0).balance.inAir == Approx(1.0).epsilon(0.03));
}

TEST_CASE("an electrode that is added during a run gives nothing for the time before")
{
    StillTheatre theatre(kWeak);
    const BodyId other = theatre.add("other", 60_mm, {.rate = 50});
    const BodyId late =
        theatre.sim.add(RigidBodyDef{.name = "late", .elements = {{{60_mm, 6_mm, 0}}, {{60_mm, 6_mm, 5_mm}}}});
    theatre.run(500);
    theatre.sim.addElectrode(late, kWeak);
    theatre.sim.activate(late, true);
    const RunReport report = theatre.run(250);
    CHECK(theatre.sim.energy(late).active == Approx(0.5));
    CHECK(theatre.sim.heat(other).delivered == Approx(1.0).epsilon(0.05));
    CHECK(report.energy.at(1).balance.inAir == Approx(0.0).margin(0.03));

    Simulation sim{SimulationDef{.physics = {.rate = 500, .threads = 1}}}; // the first electrode of all
    const BodyId stick = sim.add(RigidBodyDef{.name = "stick"});
    sim.run({.headless = true, .steps = 500});
    sim.addElectrode(stick, kWeak);
    sim.activate(stick, true);
    sim.run({.headless = true, .steps = 250});
    CHECK(sim.energy(stick).active == Approx(0.5));
}

TEST_CASE("a state has the electrodes, and a reset releases their pedals and stops the blades")
{
    Theatre theatre;
    theatre.place = Theatre::through;
    theatre.sim.addElectrode(theatre.hook, Theatre::at(EnergyMode::Cut, 60.0));
    SteppedRun run(theatre.sim);
    theatre.sim.activate(theatre.hook, true);
    for (int i = 0; i < 63; ++i) run.step();
    const auto saved = run.save();
    const auto go = [&] {
        for (int i = 0; i < 100; ++i) run.step();
        theatre.sim.activate(theatre.hook, false);
        for (int i = 0; i < 30; ++i) run.step();
        return std::pair(theatre.sim.energy(theatre.hook), theatre.sim.heat(theatre.tissue));
    };
    const auto first = go();
    CHECK(first.first.delivered > 1.0);
    CHECK(first.first.active == Approx(163 * kStep));
    run.restore(*saved);
    CHECK(go() == first);

    theatre.sim.activate(theatre.hook, true);
    run.step();
    theatre.sim.reset();
    theatre.place = [](double time) { return Theatre::through(time - 0.7); };
    double cut = 0.0;
    for (int i = 0; i < 150; ++i)
        for (const physics::Rupture& each : run.step().topology.ruptures) cut += each.area;
    CHECK(cut == 0.0);
    CHECK(theatre.sim.energy(theatre.hook) == EnergyBalance{});
}

TEST_CASE("a replay shows the burns of an electrode, to the byte")
{
    if (skipIf(!visual::hasBackend(Backend::Headless), "this build draws nothing")) return;
    const auto folder = std::filesystem::temp_directory_path() / text("filasofia_electrode_test_", getpid());
    std::filesystem::create_directory(folder);
    const auto picture = [&](const char* name, bool on) {
        Theatre theatre;
        theatre.place = Theatre::through;
        theatre.sim.addElectrode(theatre.hook, Theatre::at(EnergyMode::Cut, 60.0));
        theatre.sim.addElectrode(theatre.hook, Theatre::at(EnergyMode::Coagulate, 60.0));
        theatre.sim.show(theatre.tissue);
        theatre.sim.everyStep([&](double time) {
            theatre.sim.activate(theatre.hook, time > 0.06 && time < 0.4);
            theatre.sim.activate(theatre.hook, on && time >= 0.4 && time < 0.6, 1);
        });
        theatre.sim.run({.headless = true, .steps = 400, .picture = folder / name, .record = folder / "run.rec"});
        return visual::loadImage(folder / name).rgba;
    };
    const auto less = picture("less.png", false), burnt = picture("burnt.png", true);
    CHECK((burnt != less)); // in brackets: a million numbers are not printed
    replay({.file = folder / "run.rec", .picture = folder / "again.png"});
    CHECK((visual::loadImage(folder / "again.png").rgba == burnt));
    std::filesystem::remove_all(folder);
}

TEST_CASE("the most that an electrode may be stays finite")
{
    const double far = 1e308;
    const ElectrodeDef most{.mode = EnergyMode::Bipolar,
                            .power = 1e6,
                            .radius = 1.0,
                            .limit = 1e7,
                            .tip = {.from = {-far, far, far}, .to = {far, -far, far}},
                            .other = ElectrodeTip{.element = 1, .from = {0, 0, far}, .to = {}}};
    for (const bool bipolar : {true, false})
        for (const bool huge : {true, false}) {
            ElectrodeDef def = most;
            if (!huge) def.tip = {};
            if (!bipolar) {
                def.mode = EnergyMode::Coagulate;
                def.other.reset();
            }
            StillTheatre theatre(def);
            theatre.sim.treat(theatre.tissue, Heat{.radius = 1e-300, .power = 1e6, .limit = 1e7});
            theatre.sim.activate(theatre.stick, true);
            const RunReport report = theatre.run(200);
            const HeatBalance& heat = report.heat.at(0).balance;
            const EnergyBalance& energy = report.energy.at(0).balance;
            for (const double each : {heat.delivered, heat.stored, heat.perfused, heat.lost, heat.boiled, heat.hottest,
                                      heat.burnt, energy.delivered, energy.inAir})
                CHECK(std::isfinite(each));
            CHECK(energy.active == Approx(0.4));
            if (!huge && !bipolar) CHECK(energy.delivered > 1e5);
        }
}

TEST_CASE("wrong electrodes are one clear error")
{
    Theatre theatre;
    const auto add = [&](const ElectrodeDef& def) { theatre.sim.addElectrode(theatre.hook, def); };
    CHECK_THROWS_WITH(theatre.sim.addElectrode(theatre.tissue, {}),
                      Catch::Contains("electrode: needs a rigid body, got soft body 'tissue'"));
    CHECK_THROWS_WITH(add({.power = 0.0}), "electrode of rigid body 'hook': power must be in (0, 1000000] W, got 0");
    CHECK_THROWS_WITH(add({.radius = std::numeric_limits<double>::infinity()}), Catch::Contains("radius must be"));
    CHECK_THROWS_WITH(add({.limit = std::nan("")}), Catch::Contains("limit must be in (0, 10000000] K, got nan"));
    CHECK_THROWS_WITH(add({.tip = {.from = {std::nan(""), 0, 0}}}), Catch::Contains("tip.from"));
    CHECK_THROWS_WITH(add({.tip = {.element = 1}}),
                      "electrode of rigid body 'hook': tip.element must be in [0, 1), got 1");
    CHECK_THROWS_WITH(add({.tip = {.body = theatre.hook}}), Catch::Contains("tip.body must not be given"));
    CHECK_THROWS_WITH(add({.tip = {.through = std::vector<Vec3>(65)}}),
                      "electrode of rigid body 'hook': tip.through must have at most 64 points, got 65");
    CHECK_THROWS_WITH(add({.tip = {.through = {{0, std::nan(""), 0}}}}), Catch::Contains("tip.through"));
    CHECK_THROWS_WITH(add({.mode = EnergyMode::Bipolar, .tip = {.through = {{}}}, .other = ElectrodeTip{}}),
                      Catch::Contains("the tips of a bipolar one are straight"));
    CHECK_THROWS_WITH(add({.mode = EnergyMode::Bipolar}), Catch::Contains("other must be given if mode is bipolar"));
    CHECK_THROWS_WITH(add({.other = ElectrodeTip{}}), Catch::Contains("other needs the mode bipolar"));
    CHECK_THROWS_WITH(add({.mode = EnergyMode::Bipolar, .other = ElectrodeTip{.body = theatre.tissue}}),
                      Catch::Contains("other.body: needs a rigid body, got soft body 'tissue'"));
    CHECK_THROWS_WITH(add({.mode = EnergyMode::Bipolar, .other = ElectrodeTip{.element = 3}}),
                      Catch::Contains("other.element must be in [0, 1), got 3"));
    CHECK_THROWS_WITH(theatre.sim.activate(theatre.hook, true), Catch::Contains("has none; addElectrode() makes one"));
    const BodyId stick = theatre.sim.add(RigidBodyDef{.name = "stick"});
    CHECK_THROWS_WITH(theatre.sim.addElectrode(stick, {}),
                      "electrode of rigid body 'stick': mode cut needs a blade: none of its 0 collision models has "
                      "cutting set");
    add({});
    CHECK_THROWS_WITH(theatre.sim.activate(theatre.hook, true, 1),
                      Catch::Contains("electrode must be in [0, 1), got 1"));
    CHECK_THROWS_WITH(theatre.sim.energy(theatre.hook, -1), Catch::Contains("electrode must be in [0, 1), got -1"));
    CHECK(theatre.sim.electrodes(theatre.hook) == 1);
    CHECK(theatre.sim.electrodes(stick) == 0);
}

} // namespace electrode_test
