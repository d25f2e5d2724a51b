#include "bench/peers/options.h"

#include "bench/peers/problem.h"
#include "filasofia/core/error.h"

// Slow to compile, so it is included only here.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <iostream>

namespace filasofia::peers {
namespace {

void check(const Options& options)
{
    for (int tets : options.tets)
        if (std::find(kSizes.begin(), kSizes.end(), tets) == kSizes.end())
            fail("--tets: there is no bunny of ", tets, " tetrahedra; the sizes are 756, 1492, 3004, 10000 and 30000");
    for (double dt : options.dt)
        if (!(dt >= 1e-4 && dt <= 0.02)) fail("--dt must be in [0.0001, 0.02] s, got ", dt);
    if (options.steps < 1 || options.steps > 100000) fail("--steps must be in [1, 100000], got ", options.steps);
}

} // namespace

std::optional<Options> readOptions(int argc, char** argv)
{
    Options options;
    CLI::App app("Compares Bullet's deformable body with ours: time and error of each step.", "filasofia_peers");
    app.add_option("--tets", options.tets, "Numbers of the bunny's tetrahedra, for example 756,1492")->delimiter(',');
    app.add_option("--dt", options.dt, "Time steps in seconds, for example 0.005,0.001")->delimiter(',');
    app.add_option("--steps", options.steps, "Steps of each run");
    app.add_option("--json", options.json, "Write every figure to this file")
        ->type_name("FILE")
        ->check([](const std::string& word) { return word.empty() ? std::string("must not be empty") : ""; });
    try {
        app.parse(argc, argv);
    } catch (const CLI::CallForHelp&) {
        std::cout << app.help();
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        fail(error.what());
    }
    check(options);
    return options;
}

} // namespace filasofia::peers
