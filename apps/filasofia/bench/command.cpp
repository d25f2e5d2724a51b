#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/commands.h"
#include "apps/filasofia/json_file.h"
#include "filasofia/core/error.h"
#include "filasofia/core/text.h"
#include "filasofia/runtime/engines.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace filasofia::app {
namespace {

using nlohmann::json;

struct BenchCommandOptions {
    std::string scene;
    std::string file;
    double seconds = std::numeric_limits<double>::quiet_NaN(); ///< NaN if not given
    double soak = std::numeric_limits<double>::quiet_NaN();    ///< NaN if not given
    std::string engine = runtime::engineNames().front();
    std::string only;
    int seed = 1;
    bool quick = false;
};

constexpr double kSeconds = 10.0;     ///< [s] wall time per cell
constexpr double kQuickSeconds = 2.0; ///< [s] wall time per run of haptics if --quick is given

bool isOther(const std::string& engine) { return engine != runtime::engineNames().front(); }

/// Rejects options that do not fit the scene.
void checkOptions(const BenchCommandOptions& options)
{
    if (options.scene != "bunny" && options.scene != "solver" && options.scene != "laws" &&
        options.scene != "contact" && options.scene != "cut" && options.scene != "rod" && options.scene != "haptics" &&
        options.scene != "visual")
        fail("bench: unknown scene '", shortened(options.scene),
             "'; known are bunny, solver, laws, contact, cut, rod, haptics and visual");
    if (!std::isnan(options.seconds) && options.scene != "bunny" && options.scene != "haptics")
        fail("bench: --seconds applies to bunny and haptics only; ", options.scene, " makes a fixed number of steps");
    if (!std::isnan(options.soak) && options.scene != "contact") fail("bench: --soak applies to contact only");
    const bool inParts =
        options.scene == "rod" || (options.scene == "contact" && std::isnan(options.soak) && !isOther(options.engine));
    if (!options.only.empty() && !inParts)
        fail("bench: --only applies to the scenes of contact, without --soak and --engine, and of rod");
    if (isOther(options.engine) && options.scene != "bunny" && options.scene != "contact")
        fail("bench: --engine applies to bunny and contact only: ", options.scene, " measures the native engine");
    if (isOther(options.engine) && !std::isnan(options.soak))
        fail("bench: --soak and --engine ", options.engine, " exclude each other");
    if (isOther(options.engine) && !std::isnan(options.seconds))
        fail("bench: --seconds and --engine ", options.engine,
             " exclude each other: the latter makes a fixed number of steps");
    if (!std::isnan(options.soak) && options.quick) fail("bench: --soak and --quick exclude each other");
}

json measure(const BenchCommandOptions& options)
{
    if (options.scene == "solver") return benchSolver(options.quick);
    if (options.scene == "laws") return benchLaws(options.quick);
    if (options.scene == "cut") return benchCut(options.quick);
    if (options.scene == "rod") return benchRod(options.quick, options.only);
    if (options.scene == "visual") return benchVisual(options.quick);
    const double seconds = std::isnan(options.seconds) ? kSeconds : options.seconds;
    if (isOther(options.engine))
        return options.scene == "contact" ? benchContactEngines(options.engine, options.quick)
                                          : benchEngines(options.engine, options.quick);
    if (options.scene == "bunny") return benchBunny(seconds, options.quick);
    if (options.scene == "haptics")
        return benchHaptics(std::isnan(options.seconds) && options.quick ? kQuickSeconds : seconds, options.quick);
    return std::isnan(options.soak) ? benchContact(options.quick, options.only)
                                    : soakContact(options.soak, options.seed);
}

int bench(const BenchCommandOptions& options)
{
    checkOptions(options);
    JsonFile file(options.file);
    file.write(measure(options));
    return 0;
}

} // namespace

double fourDigits(double value)
{
    const double digits = std::pow(10.0, 3.0 - std::floor(std::log10(std::max(std::abs(value), 1e-300))));
    return std::round(value * digits) / digits;
}

Verdict atMost(const std::vector<Measured>& figures, double bound, std::string limit, double unit)
{
    if (figures.empty()) return {std::move(limit), {}, "not measured"};
    const auto named = [unit](const Measured& each) {
        return text(fourDigits(each.value / unit), " (", each.where, ")");
    };
    std::string missed;
    for (const Measured& each : figures)
        if (!(each.value <= bound)) missed += (missed.empty() ? "" : ", ") + named(each);
    const Measured& highest = *std::ranges::max_element(figures, {}, &Measured::value);
    return {std::move(limit), missed.empty(), missed.empty() ? "highest " + named(highest) : missed};
}

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
    // Static: there is one command line, and its targets must outlive this function.
    static BenchCommandOptions options;
    return {
        .name = "bench",
        .meaning = "Measure, print a table and write JSON",
        .options =
            {{"SCENE",
              &options.scene,
              "bunny: the paper's table of tetrahedra x subdivision; solver: cost of a step; laws: the same by "
              "elastic law; contact: cost of a step "
              "with bodies in contact; cut: cost of a step while a blade cuts; rod: cost of a step of threads; "
              "haptics: evenness of the haptic "
              "servo; visual: cost of a picture",
              "",
              {},
              true},
             {"--json", &options.file, "Write every figure to this file", "FILE"},
             {.name = "--seconds",
              .target = &options.seconds,
              .meaning = "Wall time of each cell of bunny and of each run of haptics",
              .type = "S",
              .bound = {openClosed(0, 3600), "s"},
              .standard = text(kSeconds)},
             {.name = "--soak",
              .target = &options.soak,
              .meaning = "contact only: instead of the costs, run random tool motions for this many simulated minutes",
              .type = "MIN",
              .bound = {openClosed(0, 600), "min"},
              .standard = "none"},
             {.name = "--seed",
              .target = &options.seed,
              .meaning = "Seed of the random tool motions of --soak",
              .type = "N",
              .bound = {closed(0, 1000000), "-"}},
             {.name = "--engine",
              .target = &options.engine,
              .meaning = "bunny and contact only: instead of the table, a step's cost, with the error or the contacts, "
                         "with this engine and the native one",
              .choices = runtime::engineNames()},
             {"--only", &options.only,
              "contact and rod only: only the scenes whose \"body, scene\" contains this, as \"three blocks\"", "TEXT"},
             {"--quick", &options.quick, "Measure only the smallest meshes"}},
        .run = [] { return bench(options); }};
}

} // namespace filasofia::app
