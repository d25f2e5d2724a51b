#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/load.h"
#include "apps/filasofia/bench/visual_frame.h"
#include "apps/filasofia/bench/visual_physics.h"
#include "filasofia/core/error.h"
#include "filasofia/core/worker_pool.h"
#include "filasofia/visual/gpu.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace filasofia::app {
namespace {

using nlohmann::json;
using runtime::Spread;

constexpr double kBudget = 4e-3;  ///< [s] main thread's time for 50,000 vertices, without the driver's part
constexpr double kMinRate = 0.95; ///< [-] physics rate beside a picture / rate without one

struct FrameRow {
    FrameScene scene;
    std::vector<FrameTimes> frames;
    double others = 0.0; ///< [-] cores used by other programs

    template <class Part> [[nodiscard]] Spread spread(const Part& part) const
    {
        std::vector<double> values;
        for (const FrameTimes& frame : frames) values.push_back(part(frame));
        return runtime::spreadOf(std::move(values));
    }
    [[nodiscard]] Spread main() const
    {
        return spread([](const FrameTimes& f) { return f.main(); });
    }
};

struct TopologyRow {
    FrameScene scene;
    Spread prepare, adopt;
};

struct PictureRow {
    PictureScene scene;
    PictureTimes times;

    [[nodiscard]] Spread capture() const { return runtime::spreadOf(times.captures); }
    [[nodiscard]] Spread depth() const { return runtime::spreadOf(times.depths); }
};

struct PhysicsRow {
    Beside beside;
    bool freeRunning;
    runtime::RunReport report;
    double others;
};

const char* nameOf(visual::Backend backend) { return backend == visual::Backend::Null ? "null" : "headless"; }
const char* nameOf(MapKind map) { return map == MapKind::Identity ? "identity" : "barycentric"; }
const char* nameOf(visual::Quality quality)
{
    return names(&quality)[std::size_t(quality)].data(); // literals, so they end in a 0
}
const char* nameOf(Beside what)
{
    return what == Beside::Nothing ? "nothing" : what == Beside::Mapping ? "mapping, null" : "picture";
}

/// The stages of a frame with their names in tables and JSON. These pictures have no Gui.
struct Part {
    const char* name;
    double (*of)(const FrameTimes&);
};
constexpr Part kParts[] = {
    {"mapping", [](const FrameTimes& f) { return f.mapping; }},
    {"subdivision", [](const FrameTimes& f) { return f.stages.subdivision; }},
    {"normals", [](const FrameTimes& f) { return f.stages.normals; }},
    {"upload", [](const FrameTimes& f) { return f.stages.upload; }},
    {"ui", [](const FrameTimes&) { return 0.0; }},
    {"submit", [](const FrameTimes& f) { return f.stages.submit; }},
    {"main", [](const FrameTimes& f) { return f.main(); }},
    {"whole", [](const FrameTimes& f) { return f.whole; }},
};

std::vector<FrameScene> frameTable(bool quick)
{
    std::vector<FrameScene> scenes;
    const bool headless = visual::hasBackend(visual::Backend::Headless);
    for (const int vertices : {5184, 50176})
        for (const int level : {0, 1, 2}) {
            if (quick && vertices > 5184) continue;
            for (const MapKind map : {MapKind::Identity, MapKind::Barycentric})
                scenes.push_back({vertices, level, map, visual::Backend::Null});
            if (headless) scenes.push_back({vertices, level, MapKind::Barycentric, visual::Backend::Headless});
        }
    return scenes;
}

void printFrame(const FrameRow& row)
{
    std::printf("%8d %5d  %-11s %-8s", row.scene.vertices, row.scene.level, nameOf(row.scene.map),
                nameOf(row.scene.backend));
    for (const Part& part : kParts) std::printf(" %8.3f", 1e3 * row.spread(part.of).median);
    std::printf(" %8.3f %6.2f\n", 1e3 * row.main().p99, row.others);
    std::fflush(stdout);
}

std::vector<FrameRow> measureFrames(bool quick)
{
    std::printf("processor time per frame [ms], medians; main: the main thread; whole: all threads, the graphics "
                "driver's included; others: cores used by other programs\n");
    std::printf("%8s %5s  %-11s %-8s", "vertices", "level", "map", "backend");
    for (const Part& part : kParts) std::printf(" %8.8s", part.name);
    std::printf(" %8s %6s\n", "main p99", "others");
    std::vector<FrameRow> rows;
    for (const FrameScene& scene : frameTable(quick)) {
        const int frames = scene.backend == visual::Backend::Null ? 300 : 60;
        const OthersLoad load;
        try {
            rows.push_back({scene, timeFrames(scene, quick ? 20 : frames)});
        } catch (const Error& error) { // for example on a machine without EGL: the other cells are still measured
            std::printf("%8d %5d  skipped: %s\n", scene.vertices, scene.level, error.what());
            continue;
        }
        rows.back().others = load.cores();
        printFrame(rows.back());
    }
    return rows;
}

std::vector<PictureRow> measurePictures(bool quick)
{
    const visual::GpuReport gpu = visual::probeGpu();
    std::printf(
        "\npictures of 50,176 vertices that move, wall time [ms], drawn by %s\n%11s %-8s %-6s %9s %9s %9s %9s\n",
        gpu.available ? gpu.renderer.c_str() : "nothing", "pixels", "quality", "optics", "captured", "p99", "depth",
        "drawn");
    std::vector<PictureRow> rows;
    if (!gpu.available) return rows;
    for (const auto& [width, height] : {std::pair{640, 480}, {960, 720}, {1920, 1080}})
        for (const visual::Quality quality : {visual::Quality::Low, visual::Quality::Medium, visual::Quality::High})
            for (const bool optics : {false, true}) {
                if (quick && (width > 640 || quality != visual::Quality::Low)) continue;
                const int frames = quick ? 5 : gpu.software ? 20 : 300;
                const PictureScene scene{width, height, quality, optics};
                rows.push_back({scene, timePictures(scene, frames)});
                const PictureRow& row = rows.back();
                std::printf("%6d x%4d %-8s %-6s %9.3f %9.3f %9.3f %9.3f\n", width, height, nameOf(quality),
                            optics ? "yes" : "no", 1e3 * row.capture().median, 1e3 * row.capture().p99,
                            1e3 * row.depth().median, 1e3 * row.times.drawn);
                std::fflush(stdout);
            }
    return rows;
}

std::vector<TopologyRow> measureTopology(bool quick)
{
    std::printf("\nnew triangles [ms], median and p99: prepare runs on the worker thread, adopt on the main "
                "thread\n%8s %5s %9s %9s "
                "%9s %9s\n",
                "vertices", "level", "prepare", "p99", "adopt", "p99");
    std::vector<TopologyRow> rows;
    for (const int vertices : {5184, 50176})
        for (const int level : {0, 1, 2}) {
            if (quick && vertices > 5184) continue;
            const FrameScene scene{vertices, level, MapKind::Identity, visual::Backend::Null};
            std::vector<double> prepare, adopt;
            for (const TopologyTimes& each : timeTopology(scene, quick ? 5 : 50)) {
                prepare.push_back(each.prepare);
                adopt.push_back(each.adopt);
            }
            rows.push_back({scene, runtime::spreadOf(std::move(prepare)), runtime::spreadOf(std::move(adopt))});
            const TopologyRow& row = rows.back();
            std::printf("%8d %5d %9.3f %9.3f %9.3f %9.3f\n", vertices, level, 1e3 * row.prepare.median,
                        1e3 * row.prepare.p99, 1e3 * row.adopt.median, 1e3 * row.adopt.p99);
            std::fflush(stdout);
        }
    return rows;
}

/// [1/s] Steps per second of wall time.
double achieved(const runtime::RunReport& report)
{
    return static_cast<double>(report.timing.stepCount) / report.timing.wallSeconds;
}

struct PhysicsRows {
    std::vector<PhysicsRow> rows;
    bool interrupted = false; ///< by Ctrl-C or SIGTERM: the rest is not measured
};

PhysicsRows measurePhysics(bool quick)
{
    std::printf("\nphysics, 3004 tetrahedra, steps of 1 ms\n%-14s %-5s %9s %9s %9s %9s %8s %7s\n", "beside", "pace",
                "steps/s", "step ms", "p99", "clamped", "pictures", "others");
    PhysicsRows all;
    std::vector<PhysicsRow>& rows = all.rows;
    const auto add = [&](Beside what, bool freeRunning) {
        if (all.interrupted) return;
        const OthersLoad load;
        try {
            rows.push_back({what, freeRunning, runBeside(what, freeRunning, quick ? 0.5 : 10.0), 0.0});
        } catch (const Error& error) {
            std::printf("%-14s %-5s skipped: %s\n", nameOf(what), freeRunning ? "free" : "1 ms", error.what());
            return;
        }
        PhysicsRow& row = rows.back();
        row.others = load.cores();
        if (row.report.finished == "interrupted") { // too short to say anything
            std::printf("%-14s %-5s interrupted: the rest is not measured, and no limit is judged\n", nameOf(what),
                        freeRunning ? "free" : "1 ms");
            rows.pop_back();
            all.interrupted = true;
            return;
        }
        const Spread cost = row.report.timing.cost();
        std::printf("%-14s %-5s %9.1f %9.3f %9.3f %9llu %8ld %7.2f\n", nameOf(what), freeRunning ? "free" : "1 ms",
                    achieved(row.report), 1e3 * cost.median, 1e3 * cost.p99,
                    static_cast<unsigned long long>(row.report.timing.clamped), row.report.visual.framesDrawn,
                    row.others);
        std::fflush(stdout);
    };
    add(Beside::Nothing, false);
    add(Beside::Mapping, false);
    if (visual::hasBackend(visual::Backend::Headless)) add(Beside::Picture, false);
    add(Beside::Nothing, true);
    // Free-running physics beside software drawing is left out: drawing would take the cores.
    add(Beside::Mapping, true);
    return all;
}

Verdict judgeBudget(const std::vector<FrameRow>& rows)
{
    Verdict verdict{
        .limit = "50,000 vertices that move in every frame take at most 4 ms of the main thread, without the driver"};
    double worst = 0.0;
    for (const FrameRow& row : rows) {
        if (row.scene.vertices < 50000 || row.scene.backend != visual::Backend::Null) continue;
        if (row.main().median <= worst) continue;
        worst = row.main().median;
        verdict.measured =
            text(rounded(1e3 * worst, 100), " ms at level ", row.scene.level, ", ", nameOf(row.scene.map));
        verdict.met = worst <= kBudget;
    }
    if (!verdict.met) verdict.measured = "not measured (--quick)";
    return verdict;
}

Verdict judgePhysics(const std::vector<PhysicsRow>& rows)
{
    Verdict verdict{.limit = "physics at 1 ms keeps 0.95 of its rate beside a picture of 640 x 480",
                    .measured = "not measured: nothing could be drawn"};
    const auto rateOf = [&](Beside what) {
        const auto row = std::ranges::find_if(
            rows, [&](const PhysicsRow& each) { return each.beside == what && !each.freeRunning; });
        return row == rows.end() ? 0.0 : achieved(row->report);
    };
    if (const double with = rateOf(Beside::Picture); with > 0.0) {
        const double ratio = with / rateOf(Beside::Nothing);
        verdict.met = ratio >= kMinRate;
        verdict.measured = text(rounded(ratio, 1000), " of ", rounded(rateOf(Beside::Nothing), 10), "/s");
    }
    return verdict;
}

json toJson(const FrameRow& row)
{
    json all = {{"vertices", row.scene.vertices}, {"level", row.scene.level},
                {"map", nameOf(row.scene.map)},   {"backend", nameOf(row.scene.backend)},
                {"frames", row.frames.size()},    {"cores_taken_by_others", row.others}};
    for (const Part& part : kParts) all[text(part.name, "_s")] = spreadToJson(row.spread(part.of));
    return all;
}

json toJson(const PictureRow& row)
{
    return {{"width", row.scene.width},
            {"height", row.scene.height},
            {"quality", nameOf(row.scene.quality)},
            {"optics", row.scene.optics},
            {"pictures", row.times.captures.size()},
            {"captured_s", spreadToJson(row.capture())},
            {"depth_s", spreadToJson(row.depth())},
            {"drawn_s", row.times.drawn}};
}

json toJson(const TopologyRow& row)
{
    return {{"vertices", row.scene.vertices},
            {"level", row.scene.level},
            {"prepare_s", spreadToJson(row.prepare)},
            {"adopt_s", spreadToJson(row.adopt)}};
}

json toJson(const PhysicsRow& row)
{
    return {{"beside", nameOf(row.beside)},
            {"pace", row.freeRunning ? "free" : "1 ms"},
            {"steps_per_s", achieved(row.report)},
            {"rate_per_s", spreadToJson(row.report.timing.rate())},
            {"cost_s", spreadToJson(row.report.timing.cost())},
            {"clamped", row.report.timing.clamped},
            {"late", row.report.timing.late},
            {"real_time_scheduling", row.report.realTime},
            {"pictures", row.report.visual.framesDrawn},
            {"cores_taken_by_others", row.others}};
}

template <class Row> json listToJson(const std::vector<Row>& rows)
{
    json all = json::array();
    for (const Row& row : rows) all.push_back(toJson(row));
    return all;
}

} // namespace

json benchVisual(bool quick)
{
    setenv("LP_NUM_THREADS", "1", 0); // if the processor draws, drawing would take every core from physics
    const std::vector<FrameRow> frames = measureFrames(quick);
    const std::vector<PictureRow> pictures = measurePictures(quick);
    const std::vector<TopologyRow> topology = measureTopology(quick);
    const auto [physics, interrupted] = measurePhysics(quick);
    const json limits = interrupted ? json::array() : printVerdicts({judgeBudget(frames), judgePhysics(physics)});
    return {{"bench", "visual"},
            {"quick", quick},
            {"cores", usableCores()},
            {"renderer", visual::probeGpu().renderer},
            {"pictures", listToJson(pictures)},
            {"frames", listToJson(frames)},
            {"topology", listToJson(topology)},
            {"physics", listToJson(physics)},
            {"interrupted", interrupted},
            {"limits", limits}};
}

} // namespace filasofia::app
