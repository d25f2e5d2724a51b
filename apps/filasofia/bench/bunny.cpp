#include "apps/filasofia/bench/bunny_limits.h"
#include "apps/filasofia/bunny_scene.h"

#include <cstdio>
#include <cstdlib>
#include <thread>

namespace filasofia::app {
namespace {

using nlohmann::json;
using runtime::RunTiming;
using runtime::Spread;

/// One cell of the table: a bunny, a render backend and a pace.
struct Cell {
    BunnyDef bunny;
    visual::Backend backend = visual::Backend::Null;
    bool freeRunning = false;
};

/// All results, including those of a run that was interrupted.
struct Results {
    std::vector<CellResult> measured;
    json cells = json::array();
    json skipped = json::array();
    bool interrupted = false;
};

constexpr double kRate = 200.0; ///< [Hz] the paper's rate: T = 5 ms
constexpr const char* kDrawThreads = "LP_NUM_THREADS";

const char* nameOf(visual::Backend backend) { return backend == visual::Backend::Null ? "null" : "filament"; }
const char* paceOf(const Cell& cell) { return cell.freeRunning ? "free" : "5 ms"; }

/// When each step began and what it cost, both in microseconds.
json series(const RunTiming& timing)
{
    json wake = json::array(), cost = json::array();
    for (const runtime::StepTiming& step : timing.steps) {
        wake.push_back(step.wake / 1000);
        cost.push_back(step.cost / 1000);
    }
    return {{"wake_us", wake}, {"cost_us", cost}};
}

/// The fields that identify a cell.
json toJson(const Cell& cell)
{
    return {{"tets", cell.bunny.tets},
            {"subdivision", cell.bunny.subdivision},
            {"backend", nameOf(cell.backend)},
            {"pace", paceOf(cell)}};
}

json toJson(const Cell& cell, const RunReport& report)
{
    json all = toJson(cell);
    all.update({{"rate_per_s", spreadToJson(report.timing.rate())},
                {"cost_s", spreadToJson(report.timing.cost())},
                {"steps", report.timing.stepCount},
                {"late", report.timing.late},
                {"clamped", report.timing.clamped},
                {"real_time_factor", report.timing.realTimeFactor()},
                {"real_time_scheduling", report.realTime},
                {"frames", report.visual.framesDrawn},
                {"series", series(report.timing)}});
    return all;
}

void printCell(const Cell& cell)
{
    std::printf("%6d  %5d  %-8s  %-5s  ", cell.bunny.tets, cell.bunny.subdivision, nameOf(cell.backend), paceOf(cell));
}

void printFigures(const RunReport& report)
{
    const Spread rate = report.timing.rate(), cost = report.timing.cost();
    std::printf("%8.1f %8.1f %8.1f  %8.3f %8.3f  %6llu %7llu  %6.2f %6ld\n", rate.median, rate.p1, rate.p99,
                cost.median * 1e3, cost.p99 * 1e3, static_cast<unsigned long long>(report.timing.late),
                static_cast<unsigned long long>(report.timing.clamped), report.timing.realTimeFactor(),
                report.visual.framesDrawn);
}

RunReport run(const Cell& cell, double seconds)
{
    Simulation sim({.physics = {.rate = kRate}, .look = {.around = bunnyRoom()}});
    addBunny(sim, cell.bunny);
    return sim.run(RunDef{.backend = cell.backend, .seconds = seconds, .freeRunning = cell.freeRunning});
}

/// Measures one cell. A cell that cannot start is reported as skipped, for example Filament's on a machine without EGL;
/// the other cells are still measured.
void measure(const Cell& cell, double seconds, Results& results)
{
    printCell(cell);
    try {
        const RunReport report = run(cell, seconds);
        printFigures(report);
        results.interrupted = report.finished == "interrupted";
        if (results.interrupted) return; // too short to say anything
        results.cells.push_back(toJson(cell, report));
        results.measured.push_back({cell.bunny.tets, cell.bunny.subdivision, nameOf(cell.backend), cell.freeRunning,
                                    report.timing.rate(), report.timing.cost()});
    } catch (const std::exception& error) {
        std::printf("skipped: %s\n", error.what());
        results.skipped.push_back(toJson(cell));
        results.skipped.back()["why"] = error.what();
    }
    std::fflush(stdout);
}

/// The paper's table; only the smallest mesh if `quick`.
std::vector<Cell> paperTable(bool quick)
{
    const std::vector<int> paper = quick ? std::vector{756} : std::vector{756, 1492, 3004};
    std::vector<Cell> cells;
    const auto add = [&](visual::Backend backend, bool freeRunning) {
        for (int tets : paper)
            for (int level : {0, 1, 2}) cells.push_back({{tets, level}, backend, freeRunning});
    };
    add(visual::Backend::Null, false);
    if (visual::hasBackend(visual::Backend::Headless)) add(visual::Backend::Headless, false);
    add(visual::Backend::Null, true);
    if (!quick)
        for (int tets : {10000, 30000}) cells.push_back({{tets, 1}, visual::Backend::Null, true});
    return cells;
}

/// If the processor draws (Mesa's llvmpipe), drawing would take every core from physics. It therefore gets one thread,
/// unless the user has set a number. The driver reads the variable when the first visual server starts.
std::string limitDrawThreads()
{
    const char* asked = std::getenv(kDrawThreads);
    if (!asked) setenv(kDrawThreads, "1", 1);
    return asked ? asked : "1";
}

std::vector<int> printSlowSizes(const std::vector<CellResult>& measured)
{
    std::vector<int> slow = slowerThanRealTime(measured);
    std::string list;
    for (int tets : slow) list += text(list.empty() ? "" : ", ", tets);
    std::printf("slower than real time at steps of 5 ms: %s\n", list.empty() ? "none of the sizes" : list.c_str());
    return slow;
}

Results measureAll(double seconds, bool quick)
{
    std::printf("%6s  %5s  %-8s  %-5s  %8s %8s %8s  %8s %8s  %6s %7s  %6s %6s\n", "tets", "level", "picture", "pace",
                "rate/s", "p1", "p99", "step ms", "p99 ms", "late", "clamped", "x real", "frames");
    Results results;
    for (const Cell& cell : paperTable(quick))
        if (!results.interrupted) measure(cell, seconds, results);
    return results;
}

} // namespace

json benchBunny(double seconds, bool quick)
{
    const std::string drawThreads = limitDrawThreads();
    std::printf("%s=%s (drawing threads, if the processor draws)\n", kDrawThreads, drawThreads.c_str());
    const Results results = measureAll(seconds, quick);
    if (!results.skipped.empty())
        std::printf("\n%zu cells were skipped; the limits below judge only the other cells", results.skipped.size());
    return {{"bench", "bunny"},
            {"rate_hz", kRate},
            {"seconds_per_cell", seconds},
            {"cores", std::thread::hardware_concurrency()},
            {"lp_num_threads", drawThreads},
            {"interrupted", results.interrupted},
            {"cells", results.cells},
            {"skipped", results.skipped},
            {"limits", printVerdicts(judgeBunny(results.measured))},
            {"slower_than_real_time", printSlowSizes(results.measured)}};
}

} // namespace filasofia::app
