#include "filasofia/filasofia.h"

#include "filasofia/core/log.h"
#include "filasofia/metric/catalog.h"
#include "filasofia/metric/session_file.h"
#include "filasofia/runtime/stepped_run.h"

#include <unistd.h>

#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <thread>

namespace metric_tracker_test {

using namespace filasofia;

namespace {

std::string temporary(const std::string& ending)
{
    return (std::filesystem::temp_directory_path() / text("filasofia_tracker_test_", getpid(), ending)).string();
}

Vec3 pathAt(double time) { return {0.01 * std::sin(6.0 * time), 0.02 * time, 0}; }

/// Probes that a script moves, each a metre from the previous one.
std::vector<TrackedBody> addProbes(Simulation& sim, int count)
{
    std::vector<TrackedBody> bodies;
    for (int i = 0; i < count; ++i) {
        const Vec3 place = {static_cast<double>(i), 0, 0};
        const BodyId id = sim.add(RigidBodyDef{.name = text("probe ", i), .elements = {{place, {}}}});
        sim.everyStep([&sim, id, place](double time) { sim.physics().setPose(id, {place + pathAt(time), {}}); });
        bodies.push_back({.body = id});
    }
    return bodies;
}

/// Collects the lines of the log while it lives.
class Log {
public:
    Log()
    {
        setLogSink([this](LogLevel, std::string_view line) { lines.emplace_back(line); });
    }
    ~Log() { setLogSink({}); }
    std::vector<std::string> lines;
};

/// A disk that takes no data until it is released.
struct StuckDisk {
    void write(std::string_view text)
    {
        std::unique_lock lock(mutex);
        free.wait(lock, [this] { return open; });
        written += text;
    }
    void release()
    {
        const std::lock_guard lock(mutex);
        open = true;
        free.notify_all();
    }
    std::mutex mutex;
    std::condition_variable free;
    bool open = false;
    std::string written;
};

metric::Session parsed(const std::string& lines)
{
    const std::string file = temporary("_parsed.jsonl");
    std::ofstream(file) << lines;
    metric::Session session = metric::readSession(file);
    std::filesystem::remove(file);
    return session;
}

} // namespace

TEST_CASE("a warning says what a session would silently miss: a target that is no body, a step that is unknown")
{
    Log log;
    Simulation sim;
    MetricTrackerDef def{.bodies = addProbes(sim, 2)};
    def.session.targets = {"probe 1", "prob 2"};
    def.session.steps = {"reach"};
    MetricTracker tracker(sim, def);
    REQUIRE(log.lines.size() == 1);
    CHECK(log.lines[0] == "metric tracker: session.targets: no body has the name 'prob 2' now");
    tracker.mark(EventKind::Step, "reach");
    CHECK(log.lines.size() == 1);
    tracker.mark(EventKind::Step, "reech");
    CHECK(log.lines.back() == "metric tracker: mark: the session has no step 'reech'");
    def.bodies[1].element = 1;
    CHECK_THROWS_WITH(MetricTracker(sim, def),
                      "metric tracker: bodies[1].element must be < 1 (elements of 'probe 1'), got 1");
}

TEST_CASE("every step of a run is sampled, the last one too, where and when it was")
{
    for (const bool headless : {true, false}) {
        Simulation sim;
        MetricTracker tracker(sim, {.bodies = addProbes(sim, 2), .rate = 1_kHz, .keep = true});
        const RunReport report = sim.run({.headless = headless, .backend = Backend::Null, .steps = 300});
        tracker.close();
        const metric::Session& session = tracker.session();
        REQUIRE(session.tracks.size() == 2);
        CHECK(session.tracks[1].name == "probe 1");
        // In a live run two steps may fall into one period of the rate: one late, the next on time.
        if (headless) REQUIRE(session.tracks[0].samples.size() == 300);
        CHECK(session.tracks[0].samples.back().time == report.time);
        CHECK(tracker.lost() == 0);
        for (const metric::Sample& sample : session.tracks[0].samples)
            CHECK(distance(sample.pose.position, pathAt(sample.time)) < 1e-12);
    }
}

TEST_CASE("a restored state takes back what was measured after it, and a table for spreadsheets goes only on")
{
    const std::string file = temporary("_back.jsonl"), table = temporary("_back.csv");
    const auto timesOf = [](const metric::Session& session) {
        std::vector<double> out;
        for (const metric::Sample& sample : session.tracks[0].samples) out.push_back(sample.time);
        for (const metric::Event& each : session.events) out.push_back(each.time);
        return out;
    };
    const auto near = [](std::vector<double> times) { return Catch::Matchers::Approx(times).margin(1e-9); };
    Simulation sim;
    const std::vector<TrackedBody> probes = addProbes(sim, 1);
    MetricTracker tracker(sim, {.bodies = probes, .rate = 250, .file = file, .keep = true});
    MetricTracker detour(sim, {.bodies = probes, .rate = 250, .keep = true});
    std::optional<MetricTracker> csv(std::in_place, sim, MetricTrackerDef{.bodies = probes, .file = table});
    runtime::SteppedRun run(sim);
    const auto steps = [&run](int count) {
        for (int i = 0; i < count; ++i) run.step();
    };
    steps(30); // between two samples
    tracker.mark(EventKind::Note, "kept");
    const auto early = run.save();
    CHECK_THROWS_WITH(run.restore(*early), Catch::Contains("_back.csv', where time only goes on"));
    csv.reset();
    steps(21);
    const auto late = run.save();
    steps(70);
    tracker.mark(EventKind::Note, "taken back");
    run.restore(*late);
    steps(5);
    run.restore(*early);
    steps(71);
    tracker.mark(EventKind::Note, "kept, too");
    tracker.close();
    std::vector<double> expected = {1e-3};
    for (int i = 4; i <= 100; i += 4) expected.push_back(i * 1e-3);
    for (const double time : {0.030, 0.101}) expected.push_back(time);
    CHECK_THAT(timesOf(tracker.session()), near(expected));
    CHECK(timesOf(metric::readSession(file)) == timesOf(tracker.session()));
    CHECK(tracker.lost() == 0);

    // What led to a state that was taken back is gone: the session begins with it.
    run.restore(*late);
    steps(6);
    detour.close();
    CHECK_THAT(timesOf(detour.session()), near({0.051, 0.052, 0.056}));
    std::filesystem::remove(file);
    std::filesystem::remove(table);
}

TEST_CASE("four bodies at 1 kHz: while writes are blocked for a second no sample is lost and physics does not wait")
{
    StuckDisk disk;
    Simulation sim;
    MetricTracker tracker(
        sim, {.bodies = addProbes(sim, 4), .rate = 1_kHz, .write = [&](std::string_view lines) { disk.write(lines); }});
    // The run ends although nothing was written: physics did not wait.
    CHECK(sim.run({.headless = true, .steps = 1000}).steps == 1000);
    CHECK(disk.written.empty());
    disk.release();
    CHECK(sim.run({.headless = true, .steps = 500}).steps == 1500);
    tracker.close();
    CHECK(tracker.lost() == 0);
    CHECK(tracker.taken() == 1500);
    const metric::Session session = parsed(disk.written);
    CHECK(session.complete);
    REQUIRE(session.tracks.size() == 4);
    for (const metric::Track& track : session.tracks) {
        REQUIRE(track.samples.size() == 1500);
        for (std::size_t i = 0; i < 1500; ++i)
            CHECK(track.samples[i].time == Approx(1e-3 * static_cast<double>(i + 1)).epsilon(1e-9));
    }
}

TEST_CASE("blocked for longer than its buffer it loses samples, counts them, and says so in the session")
{
    StuckDisk disk;
    Simulation sim;
    const MetricTrackerDef def = {.bodies = addProbes(sim, 1),
                                  .rate = 1_kHz,
                                  .buffer = 0.25,
                                  .write = [&](std::string_view lines) { disk.write(lines); }};
    CHECK(MetricTracker::memory(def) < 64'000);
    MetricTracker tracker(sim, def);
    sim.run({.headless = true, .steps = 1000});
    CHECK(tracker.lost() > 0);
    CHECK(tracker.taken() + tracker.lost() >= 999);
    disk.release();
    tracker.close();
    const metric::Session session = parsed(disk.written);
    CHECK(session.lost == tracker.lost());
    CHECK(session.tracks[0].samples.size() == tracker.taken());
}

TEST_CASE("a writer that throws something that is not a std::exception ends the session like any other")
{
    Simulation sim;
    MetricTracker tracker(sim, {.bodies = addProbes(sim, 1), .rate = 1_kHz, .write = [](std::string_view lines) {
                                    if (lines.find("\"end\"") == std::string_view::npos) throw 42;
                                }});
    sim.run({.headless = true, .steps = 50});
    tracker.close();
    CHECK(tracker.failed());
}

TEST_CASE("a run that is faster than its disk waits for it, as long as it is ahead of real time")
{
    int lines = 0;
    Simulation sim;
    MetricTracker tracker(
        sim, {.bodies = addProbes(sim, 4), .rate = 1_kHz, .buffer = 0.1, .write = [&](std::string_view text) {
                  lines += static_cast<int>(std::count(text.begin(), text.end(), '\n'));
              }});
    sim.run({.headless = true, .steps = 20'000});
    tracker.close();
    CHECK(tracker.lost() == 0);
    CHECK(tracker.taken() == 20'000);
    CHECK(lines == 20'002); // with head and end
}

TEST_CASE("a lower rate takes every fifth step")
{
    Simulation sim;
    MetricTracker tracker(sim, {.bodies = addProbes(sim, 1), .rate = 200, .keep = true});
    sim.run({.headless = true, .steps = 1000});
    tracker.close();
    const auto& samples = tracker.session().tracks[0].samples;
    REQUIRE(samples.size() >= 200);
    CHECK(samples.size() <= 201);
    for (std::size_t i = 2; i < samples.size(); ++i) CHECK(samples[i].time - samples[i - 1].time == Approx(5e-3));
}

TEST_CASE("a full disk is one line in the log and an event, and the session goes on")
{
    const std::string file = temporary(".jsonl");
    std::filesystem::create_symlink("/dev/full", file);
    Log log;
    Simulation sim;
    std::atomic<int> troubles = 0;
    sim.on<FileFailedEvent>([&](const FileFailedEvent&) { ++troubles; });
    {
        MetricTracker tracker(sim, {.bodies = addProbes(sim, 1), .rate = 1_kHz, .file = file, .keep = true});
        CHECK(sim.run({.headless = true, .steps = 500}).steps == 500);
        tracker.close();
        CHECK(tracker.failed());
        CHECK(tracker.lost() == 0);
        CHECK(tracker.session().tracks[0].samples.size() == 500); // the copy in memory is complete
    }
    sim.run({.headless = true, .steps = 1}); // delivers the posted event
    CHECK(troubles == 1);
    REQUIRE(log.lines.size() == 1);
    CHECK(log.lines[0] ==
          text("metric tracker: ", file, ": cannot be written (disk full?); the session goes on without recording"));
    std::filesystem::remove(file);
}

TEST_CASE("forces of contact, tears and what the simulator marks are in the session")
{
    Simulation sim;
    const BodyId block = sim.add(SoftBodyDef{.name = "liver",
                                             .mesh = shapes::block({20_mm, 20_mm, 20_mm}, {2, 2, 2}),
                                             .attachments = {{.box = Box{{-1, -1, -1}, {1, -9.9_mm, 1}}}},
                                             .collision = {{}}});
    const BodyId ball = sim.add(RigidBodyDef{
        .name = "ball", .elements = {{{0, 16_mm, 0}, {}}}, .mesh = shapes::sphere(5_mm), .collision = {{}}});
    sim.everyStep([&](double time) { sim.physics().setPose(ball, {{0, 16_mm - 0.02 * time, 0}, {}}); });
    MetricTracker tracker(sim, {.bodies = {{.body = ball, .name = "probe"}, {.body = block, .role = Role::Other}},
                                .rate = 1_kHz,
                                .keep = true,
                                .session = {.trainee = "Ada", .steps = {"touch"}}});
    double largest = 0.0;
    sim.on<PhysicsUpdateEvent>([&](const PhysicsUpdateEvent& update) {
        for (const auto& pair : frame::contactPairs(sim.physics().latest()->contacts))
            largest = std::max(largest, length(pair.force));
        if (update.step == 150) tracker.mark(EventKind::Step, "touch");
        if (update.step == 160) {
            auto tear = std::make_unique<TearEvent>();
            tear->rupture = {.kind = Rupture::Kind::Tear, .body = block, .area = 1e-5};
            sim.post(std::move(tear));
        }
    });
    sim.run({.headless = true, .steps = 200});
    tracker.close();
    const metric::Session& session = tracker.session();
    CHECK_FALSE(session.date.empty());
    CHECK(session.software.starts_with("Filasofia "));
    CHECK(session.tracks[0].name == "probe");
    CHECK(session.tracks[1].name == "liver");
    REQUIRE(session.events.size() == 2);
    CHECK(session.events[0].what == "touch");
    CHECK(session.events[0].time == Approx(0.150));
    CHECK(session.events[1].kind == EventKind::Tear);
    CHECK(session.events[1].what == "liver");
    CHECK(session.events[1].amount == 1e-5);
    const auto values = metric::measure(session, {.forceWindow = 0.0}); // the maximum over single steps
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (metric::catalog()[i].id == "force_max") {
            CHECK(largest > 0.01);
            CHECK(*values[i].value == Approx(largest));
        }
        if (metric::catalog()[i].id == "steps_done") CHECK(*values[i].value == 1.0);
        if (metric::catalog()[i].id == "tears_unintended") CHECK(*values[i].value == 1.0);
    }
    // Action and reaction: the force on the ball is opposite to the force on the block.
    const metric::Sample &tool = session.tracks[0].samples.back(), &organ = session.tracks[1].samples.back();
    CHECK(length(tool.force + organ.force) < 1e-12);
    CHECK(tool.contacts > 0);
}

TEST_CASE("a session has the blood that its bodies lose")
{
    Simulation sim;
    const BodyId liver = sim.add(SoftBodyDef{.name = "liver", .mesh = shapes::block({20_mm, 20_mm, 20_mm}, {4, 4, 4})});
    sim.bleed(liver, {.flux = 1e-3});
    sim.treat(liver, Injure{{0, 10_mm, 0}, 8_mm});
    MetricTracker tracker(sim, {.bodies = {{.body = liver, .role = Role::Other}}, .keep = true});
    sim.run({.headless = true, .steps = 2100});
    tracker.close();
    const auto values = metric::measure(tracker.session());
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (metric::catalog()[i].id != "blood_lost") continue;
        CHECK(*values[i].value > 0.0);
        CHECK(*values[i].value <= sim.blood(liver).welled);
        CHECK(*values[i].value > 0.8 * sim.blood(liver).welled);
    }
}

TEST_CASE("a session has what electrodes do, and what they burn beside the target")
{
    Simulation sim;
    const auto add = [&](const char* name, double x, bool target) {
        SoftBodyDef def{.name = name, .mesh = shapes::block({20_mm, 20_mm, 20_mm}, {8, 4, 8})};
        def.pose.position = {x, 0, 0};
        def.attachments = {{.box = Box{{-1, -1, -1}, {1, 1, 1}}}};
        const BodyId id = sim.add(def);
        sim.burn(id, {.depth = 0.5_mm, .target = target});
        return id;
    };
    add("liver", 0.0, true);
    const BodyId bowel = add("bowel", 20.5_mm, false);
    const BodyId stick = sim.add(RigidBodyDef{.name = "stick", .elements = {{{10.25_mm, 10_mm, 0}}}});
    sim.addElectrode(stick, {.mode = EnergyMode::Coagulate, .power = 20.0, .radius = 3_mm});
    sim.everyStep([&](double time) { // on for a second, then for half a second in air
        sim.physics().setPose(stick, {{10.25_mm, time > 1.5 ? 50_mm : 10_mm, 0}});
        sim.activate(stick, time < 1.0 || (time > 2.0 && time < 2.5));
    });
    MetricTracker tracker(sim, {.bodies = {{.body = stick}}, .keep = true});
    sim.run({.headless = true, .steps = 3100});
    tracker.close();
    const auto values = metric::measure(tracker.session());
    const auto number = [&](std::string_view id) {
        for (std::size_t i = 0; i < values.size(); ++i)
            if (metric::catalog()[i].id == id) return values[i].value.value_or(-1.0);
        return -1.0;
    };
    CHECK(number("activation_time") == Approx(sim.energy(stick).active));
    CHECK(number("activation_time") == Approx(1.5).margin(0.003));
    CHECK(number("activation_in_air") == Approx(0.5).margin(0.02));
    CHECK(number("energy_delivered") == Approx(sim.energy(stick).delivered));
    CHECK(number("energy_delivered") > 5.0);
    CHECK(number("burnt_unintended") == Approx(sim.heat(bowel).burnt));
    CHECK(number("burnt_unintended") > 1e-6);
}

TEST_CASE("a file for spreadsheets has a row per moment, and names that cannot act as formulas")
{
    const std::string file = temporary(".csv");
    Simulation sim;
    auto bodies = addProbes(sim, 1);
    bodies[0].name = "=cmd|' /C calc'!A0";
    {
        MetricTracker tracker(sim, {.bodies = bodies, .rate = 100, .file = file});
        sim.run({.headless = true, .steps = 100});
        tracker.mark(EventKind::Note, "+\"quoted\"");
        sim.run({.headless = true, .steps = 100});
    }
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    CHECK(line.starts_with("time [s],\"'=cmd|' /C calc'!A0 x [m]\","));
    const auto commas = std::count(line.begin(), line.end(), ',');
    int rows = 0, notes = 0;
    while (std::getline(stream, line)) {
        CHECK(std::count(line.begin(), line.end(), ',') == commas);
        line.find("\"note\",\"'+\"\"quoted\"\"\",") != std::string::npos ? ++notes : ++rows;
    }
    CHECK(rows == 21); // at 0.001 s, the first step, and then every 0.01 s
    CHECK(notes == 1);
    std::filesystem::remove(file);
}

TEST_CASE("two trackers, or a tracker and a log, cannot write the same file")
{
    const std::string file = temporary("_twice.csv");
    Simulation sim;
    const MetricTrackerDef def{.bodies = addProbes(sim, 1), .file = file};
    MetricTracker tracker(sim, def);
    const std::string taken = file + ": is already being written, under this or another name";
    CHECK_THROWS_WITH(MetricTracker(sim, def), "metric tracker: " + taken);
    CHECK_THROWS_WITH(sim.run({.headless = true, .steps = 3, .log = file}), taken);
    tracker.close();
    CHECK_NOTHROW(MetricTracker(sim, def));
    CHECK_THROWS_WITH(MetricTracker(sim, {.bodies = def.bodies, .file = std::string("a\0.csv", 6)}),
                      "metric tracker: a .csv: a file name must not have a byte of value 0");
    std::filesystem::remove(file);
}

TEST_CASE("the lines of a session ascend in time: an event stands before the sample of its step")
{
    const std::string file = temporary("_order.csv");
    Simulation sim({.physics = {.rate = 1000.0}});
    MetricTracker tracker(sim, {.bodies = addProbes(sim, 1), .rate = 1000.0, .file = file});
    int step = 0;
    sim.everyStep([&](double) {
        if (++step % 10 == 0) tracker.mark(metric::EventKind::Note, text(step));
    });
    sim.run({.headless = true, .steps = 2000});
    tracker.close();
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    double last = 0.0;
    int descents = 0, lines = 0;
    for (; std::getline(in, line); ++lines) {
        const double time = std::stod(line);
        descents += time < last ? 1 : 0;
        last = time;
    }
    CHECK(lines > 2190);
    CHECK(descents == 0);
    std::filesystem::remove(file);
}

TEST_CASE("a tracker may end before the run, and the simulation goes on")
{
    Simulation sim;
    const auto bodies = addProbes(sim, 1);
    {
        MetricTracker tracker(sim, {.bodies = bodies, .keep = true});
        sim.run({.headless = true, .steps = 10});
    }
    CHECK(sim.run({.headless = true, .steps = 10}).steps == 20);
}

TEST_CASE("a wrong tracker Def is refused with its field")
{
    Simulation sim;
    const auto bodies = addProbes(sim, 1);
    using Def = MetricTrackerDef;
    CHECK_THROWS_WITH(MetricTracker(sim, {}), "metric tracker: bodies must be in [1, 64], got 0");
    CHECK_THROWS_WITH(MetricTracker(sim, (Def{.bodies = bodies, .rate = 0})),
                      "metric tracker: rate must be in [1, 100000] Hz, got 0");
    CHECK_THROWS_WITH(MetricTracker(sim, (Def{.bodies = bodies, .file = "session.txt"})),
                      "metric tracker: file must end in .jsonl or .csv, got 'session.txt'");
    CHECK_THROWS_WITH(MetricTracker(sim, (Def{.bodies = bodies, .file = "/nowhere/s.jsonl"})),
                      "metric tracker: /nowhere/s.jsonl: cannot be written");
    CHECK_THROWS_AS(MetricTracker(sim, (Def{.bodies = {{.body = BodyId{77}}}})), Error);
    CHECK_THROWS_WITH(MetricTracker(sim, (Def{.bodies = {{.body = bodies[0].body, .axis = {}}}})),
                      "metric tracker: bodies[0].axis must have a length > 0, got 0 0 0");
    CHECK_THROWS_WITH(MetricTracker(sim, (Def{.bodies = bodies, .session = {.forceLimit = -1.0}})),
                      "metric tracker: session.forceLimit must be > 0, got -1");
    MetricTracker tracker(sim, {.bodies = bodies});
    CHECK_THROWS_WITH(tracker.session(), "metric tracker: session() needs keep");
}

} // namespace metric_tracker_test
