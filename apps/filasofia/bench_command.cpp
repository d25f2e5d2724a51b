#include "apps/filasofia/bench.h"
#include "apps/filasofia/commands.h"
#include "filasofia/core/error.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

namespace filasofia::app {
namespace {

using nlohmann::json;

struct Options {
    std::string scene;
    std::string file;
    double seconds = std::numeric_limits<double>::quiet_NaN(); ///< not given
    bool quick = false;
};

constexpr double kSeconds = 10.0; ///< [s] of a cell

/// Which bench it is; refuses what it cannot do.
bool isSolver(const Options& options)
{
    const bool given = !std::isnan(options.seconds);
    if (options.scene == "solver") {
        if (given) fail("bench: --seconds is for bunny; solver makes a fixed number of steps");
        return true;
    }
    if (options.scene != "bunny") fail("bench: there is no scene '", options.scene, "'; there are bunny and solver");
    if (given && !(options.seconds > 0.0 && options.seconds <= 3600.0))
        fail("bench: --seconds must be in (0, 3600], got ", options.seconds);
    return false;
}

/// Opened before the minutes of measuring, not after.
std::ofstream open(const std::string& file)
{
    std::ofstream out;
    if (file.empty()) return out;
    out.open(file);
    if (!out) fail(file, ": cannot be written");
    return out;
}

int bench(const Options& options)
{
    const bool solver = isSolver(options);
    std::ofstream out = open(options.file);
    const double seconds = std::isnan(options.seconds) ? kSeconds : options.seconds;
    const json all = solver ? benchSolver(options.quick) : benchBunny(seconds, options.quick);
    if (!out.is_open()) return 0;
    out << all.dump(-1, ' ', false, json::error_handler_t::replace) << '\n'; // a driver's words may hold any bytes
    if (!out.flush()) fail(options.file, ": cannot be written (disk full?)");
    std::printf("wrote %s\n", options.file.c_str());
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
            .options = {{"SCENE",
                         &options.scene,
                         "bunny: the paper's table of tetrahedra x subdivision; solver: what a step costs",
                         "",
                         {},
                         true},
                        {"--json", &options.file, "Write every figure to this file", "FILE"},
                        {"--seconds", &options.seconds, "Wall time of each of bunny's cells, 10 unless given", "S"},
                        {"--quick", &options.quick, "Only the smallest meshes"}},
            .run = [] { return bench(options); }};
}

} // namespace filasofia::app
