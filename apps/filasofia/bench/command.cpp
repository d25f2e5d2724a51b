#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/commands.h"
#include "apps/filasofia/json_file.h"
#include "filasofia/core/error.h"

#include <cmath>
#include <cstdio>
#include <limits>

namespace filasofia::app {
namespace {

using nlohmann::json;

struct Options {
    std::string scene;
    std::string file;
    double seconds = std::numeric_limits<double>::quiet_NaN(); ///< not given
    double soak = std::numeric_limits<double>::quiet_NaN();    ///< not given
    int seed = 1;
    bool quick = false;
};

constexpr double kSeconds = 10.0;     ///< [s] of a cell
constexpr double kQuickSeconds = 2.0; ///< [s] of a quick run of haptics

/// Refuses what it cannot do.
void checkOptions(const Options& options)
{
    if (options.scene != "bunny" && options.scene != "solver" && options.scene != "contact" && options.scene != "cut" &&
        options.scene != "haptics" && options.scene != "visual")
        fail("bench: there is no scene '", shortened(options.scene),
             "'; there are bunny, solver, contact, cut, haptics and visual");
    if (!std::isnan(options.seconds) && options.scene != "bunny" && options.scene != "haptics")
        fail("bench: --seconds is for bunny and haptics; ", options.scene, " makes a fixed number of steps");
    if (!std::isnan(options.soak) && options.scene != "contact") fail("bench: --soak is for contact");
    if (!std::isnan(options.soak) && options.quick) fail("bench: --soak says how long it takes: no --quick");
}

json measure(const Options& options)
{
    if (options.scene == "solver") return benchSolver(options.quick);
    if (options.scene == "cut") return benchCut(options.quick);
    if (options.scene == "visual") return benchVisual(options.quick);
    const double seconds = std::isnan(options.seconds) ? kSeconds : options.seconds;
    if (options.scene == "bunny") return benchBunny(seconds, options.quick);
    if (options.scene == "haptics")
        return benchHaptics(std::isnan(options.seconds) && options.quick ? kQuickSeconds : seconds, options.quick);
    return std::isnan(options.soak) ? benchContact(options.quick) : soakContact(options.soak, options.seed);
}

int bench(const Options& options)
{
    checkOptions(options);
    JsonFile file(options.file);
    file.write(measure(options));
    return 0;
}

} // namespace

json printVerdicts(const std::vector<Verdict>& verdicts)
{
    json all = json::array();
    std::printf("\n");
    for (const Verdict& verdict : verdicts) {
        const char* word = !verdict.met ? "unknown" : *verdict.met ? "met" : "MISSED";
        std::printf("%-7s  %s: %s\n", word, verdict.limit.c_str(), verdict.measured.c_str());
        all.push_back({{"limit", verdict.limit},
                       {"met", verdict.met ? json(*verdict.met) : json()},
                       {"measured", verdict.measured}});
    }
    return all;
}

json spreadToJson(const runtime::Spread& spread)
{
    return {{"median", spread.median}, {"p1", spread.p1}, {"p99", spread.p99}};
}

double rounded(double value, double digits) { return std::round(value * digits) / digits; }

Command benchCommand()
{
    static Options options; // there is one command line, and it outlives this function
    return {.name = "bench",
            .meaning = "Measure, print a table and write JSON",
            .options =
                {{"SCENE",
                  &options.scene,
                  "bunny: the paper's table of tetrahedra x subdivision; solver: what a step costs; contact: what it "
                  "costs where bodies touch; cut: what it costs while a blade cuts; haptics: how evenly a hand is "
                  "pushed; visual: what a picture costs",
                  "",
                  {},
                  true},
                 {"--json", &options.file, "Write every figure to this file", "FILE"},
                 {.name = "--seconds",
                  .target = &options.seconds,
                  .meaning = "Wall time of each of bunny's cells, and of haptics' runs",
                  .type = "S",
                  .bound = {openClosed(0, 3600), "s"},
                  .standard = text(kSeconds)},
                 {.name = "--soak",
                  .target = &options.soak,
                  .meaning = "Of contact: a tool at random for so many simulated minutes, in place of the costs",
                  .type = "MIN",
                  .bound = {openClosed(0, 600), "min"},
                  .standard = "none"},
                 {.name = "--seed",
                  .target = &options.seed,
                  .meaning = "Of the soak's tool",
                  .type = "N",
                  .bound = {closed(0, 1000000), "-"}},
                 {"--quick", &options.quick, "Only the smallest meshes"}},
            .run = [] { return bench(options); }};
}

} // namespace filasofia::app
