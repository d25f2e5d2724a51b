#include "apps/filasofia/bunny_scene.h"
#include "apps/filasofia/commands.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <fstream>
#include <thread>

namespace filasofia::app {
namespace {

using nlohmann::json;
using runtime::RunTiming;
using runtime::Spread;

struct Options {
    std::string scene;
    std::string file;
    double seconds = 10.0;
};

/// One cell of the table: a bunny, a picture, a way to pace.
struct Cell {
    BunnyDef bunny;
    visual::Backend backend = visual::Backend::Null;
    bool freeRunning = false;
};

constexpr double kRate = 200.0; ///< [Hz], the paper's: T = 5 ms

const char* nameOf(visual::Backend backend) { return backend == visual::Backend::Null ? "null" : "filament"; }

json toJson(const Spread& spread) { return {{"median", spread.median}, {"p1", spread.p1}, {"p99", spread.p99}}; }

/// Microseconds: when each step began, and what it cost.
json series(const RunTiming& timing)
{
    json wake = json::array(), cost = json::array();
    for (const runtime::StepTiming& step : timing.steps) {
        wake.push_back(step.wake / 1000);
        cost.push_back(step.cost / 1000);
    }
    return {{"wake_us", wake}, {"cost_us", cost}};
}

json measure(const Cell& cell, double seconds)
{
    Simulation sim({.physics = {.rate = kRate}, .look = {.around = bunnyRoom()}});
    addBunny(sim, cell.bunny);
    const RunReport report =
        sim.run(RunDef{.backend = cell.backend, .seconds = seconds, .freeRunning = cell.freeRunning});
    const Spread rate = report.timing.rate(), cost = report.timing.cost();
    std::printf("%6d  %5d  %-8s  %-5s  %8.1f %8.1f %8.1f  %8.3f %8.3f  %6llu %7llu  %6.2f %6ld\n", cell.bunny.tets,
                cell.bunny.subdivision, nameOf(cell.backend), cell.freeRunning ? "free" : "5 ms", rate.median, rate.p1,
                rate.p99, cost.median * 1e3, cost.p99 * 1e3, static_cast<unsigned long long>(report.timing.late),
                static_cast<unsigned long long>(report.timing.clamped), report.timing.realTimeFactor(),
                report.visual.framesDrawn);
    std::fflush(stdout);
    return {{"tets", cell.bunny.tets},
            {"subdivision", cell.bunny.subdivision},
            {"backend", nameOf(cell.backend)},
            {"pace", cell.freeRunning ? "free" : "5 ms"},
            {"rate_per_s", toJson(rate)},
            {"cost_s", toJson(cost)},
            {"steps", report.timing.stepCount},
            {"late", report.timing.late},
            {"clamped", report.timing.clamped},
            {"real_time_factor", report.timing.realTimeFactor()},
            {"real_time_scheduling", report.realTime},
            {"frames", report.visual.framesDrawn},
            {"series", series(report.timing)}};
}

std::vector<Cell> paperTable()
{
    std::vector<Cell> cells;
    for (int tets : {756, 1492, 3004})
        for (int level : {0, 1, 2}) cells.push_back({{tets, level}, visual::Backend::Null, false});
    if (visual::hasBackend(visual::Backend::Headless))
        for (int tets : {756, 1492, 3004})
            for (int level : {0, 1, 2}) cells.push_back({{tets, level}, visual::Backend::Headless, false});
    for (int tets : {756, 1492, 3004})
        for (int level : {0, 1, 2}) cells.push_back({{tets, level}, visual::Backend::Null, true});
    for (int tets : {10000, 30000}) cells.push_back({{tets, 1}, visual::Backend::Null, true});
    return cells;
}

int bench(const Options& options)
{
    if (options.scene != "bunny") fail("bench: there is no scene '", options.scene, "'; there is bunny");
    if (!(options.seconds > 0.0 && options.seconds <= 3600.0))
        fail("bench: --seconds must be in (0, 3600], got ", options.seconds);
    std::ofstream out;
    if (!options.file.empty()) {
        out.open(options.file); // before the minutes of measuring, not after
        if (!out) fail(options.file, ": cannot be written");
    }
    json cells = json::array();
    std::printf("%6s  %5s  %-8s  %-5s  %8s %8s %8s  %8s %8s  %6s %7s  %6s %6s\n", "tets", "level", "picture", "pace",
                "rate/s", "p1", "p99", "step ms", "p99 ms", "late", "clamped", "x real", "frames");
    for (const Cell& cell : paperTable()) cells.push_back(measure(cell, options.seconds));
    if (out.is_open()) {
        const json all = {{"bench", "bunny"},
                          {"rate_hz", kRate},
                          {"seconds_per_cell", options.seconds},
                          {"cores", std::thread::hardware_concurrency()},
                          {"cells", cells}};
        out << all.dump() << '\n';
        if (!out.flush()) fail(options.file, ": cannot be written (disk full?)");
        std::printf("wrote %s\n", options.file.c_str());
    }
    return 0;
}

} // namespace

Command benchCommand()
{
    static Options options; // there is one command line, and it outlives this function
    return {.name = "bench",
            .meaning = "Measure, print a table and write JSON",
            .options = {{"SCENE", &options.scene, "bunny: the paper's table of tetrahedra x subdivision", "", {}, true},
                        {"--json", &options.file, "Write every figure and the time series to this file", "FILE"},
                        {"--seconds", &options.seconds, "Wall time of each cell", "S"}},
            .run = [] { return bench(options); }};
}

} // namespace filasofia::app
