#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/solver_run.h"
#include "filasofia/core/text.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/geometry/mesh_file.h"
#include "filasofia/runtime/assets.h"
#include "filasofia/runtime/clock.h"

#include <algorithm>
#include <cstdio>

namespace filasofia::app {
namespace {

using nlohmann::json;
using physics::ElasticLaw;
using Mesh = std::shared_ptr<const geometry::TetMesh>;

constexpr double kStep = 5e-3; ///< [s]
constexpr int kSteps = 100;    ///< for one run from rest, in which the bunny falls and swings
constexpr int kWarmUp = 10;    ///< steps of a run that are not timed

/// The laws with their defaults, the corotational one first: the others are compared with it.
std::vector<ElasticLaw> laws()
{
    std::vector<ElasticLaw> all = physics::elasticLaws();
    std::stable_partition(all.begin(), all.end(),
                          [](const ElasticLaw& law) { return std::holds_alternative<physics::Corotational>(law); });
    return all;
}

physics::SoftBodyDef bunny(const Mesh& mesh, const ElasticLaw& law, const physics::Solver& solver)
{
    return solverBunny(mesh, Hold::Head, solver, {.youngModulus = 10e3, .poissonRatio = 0.45, .law = law});
}

/// One law on one mesh.
struct LawTimes {
    std::string law;
    int tetrahedra = 0;
    std::vector<double> steps = {};   ///< [s] in all repetitions
    std::vector<double> medians = {}; ///< [s] one per repetition
    long iterations = 0;
    std::uint32_t flags = 0;
    double error = 0.0; ///< [-] in the displacement after a run, relative to it
};

/// Where the nodes are after a run from rest.
std::vector<Vec3> endOf(const Mesh& mesh, const ElasticLaw& law, const physics::Solver& solver)
{
    SolverRun run(bunny(mesh, law, solver), kStep, 1);
    for (int i = 0; i < kSteps; ++i) run.step();
    return run.state().positions;
}

void repeat(SolverRun& run, LawTimes& times)
{
    const auto now = runtime::steadyClock().now;
    std::vector<double> costs;
    run.backToRest();
    for (int i = 0; i < kSteps; ++i) {
        const runtime::Nanoseconds begun = now();
        const physics::StepReport report = run.step();
        const runtime::Nanoseconds ended = now();
        times.flags |= report.flags;
        if (i < kWarmUp) continue;
        costs.push_back(1e-9 * static_cast<double>(ended - begun));
        times.iterations += report.solves.front().iterations;
    }
    times.medians.push_back(runtime::spreadOf(costs).median);
    times.steps.insert(times.steps.end(), costs.begin(), costs.end());
}

/// Times all laws on a mesh in turns, so that a slow minute of the machine slows all alike.
std::vector<LawTimes> measure(const Mesh& mesh, int repetitions)
{
    std::vector<LawTimes> all;
    std::vector<std::unique_ptr<SolverRun>> runs;
    for (const ElasticLaw& law : laws()) {
        LawTimes times{.law = std::string(physics::nameOf(law)),
                       .tetrahedra = static_cast<int>(mesh->tetrahedra.size())};
        const std::vector<Vec3> exact = endOf(mesh, law, physics::ConjugateGradient{.tolerance = 1e-5});
        const std::vector<Vec3> found = endOf(mesh, law, physics::ConjugateGradient{});
        times.error = distanceOf(found, exact) / distanceOf(exact, mesh->nodes);
        all.push_back(std::move(times));
        runs.push_back(std::make_unique<SolverRun>(bunny(mesh, law, physics::ConjugateGradient{}), kStep, 1));
    }
    for (int i = 0; i < repetitions; ++i)
        for (std::size_t l = 0; l < runs.size(); ++l) repeat(*runs[l], all[l]);
    return all;
}

runtime::Spread ratioTo(const LawTimes& base, const LawTimes& times)
{
    std::vector<double> ratios;
    for (std::size_t i = 0; i < times.medians.size(); ++i) ratios.push_back(times.medians[i] / base.medians[i]);
    return runtime::spreadOf(ratios);
}

double iterationsOf(const LawTimes& times)
{
    return static_cast<double>(times.iterations) / static_cast<double>(times.steps.size());
}

json toJson(const LawTimes& base, const LawTimes& times)
{
    return {{"law", times.law},
            {"tetrahedra", times.tetrahedra},
            {"dt_s", kStep},
            {"step_s", spreadToJson(runtime::spreadOf(times.steps))},
            {"over_corotational", spreadToJson(ratioTo(base, times))},
            {"iterations_mean", iterationsOf(times)},
            {"error", times.error},
            {"flags", times.flags}};
}

void print(const LawTimes& base, const LawTimes& times)
{
    const runtime::Spread step = runtime::spreadOf(times.steps), ratio = ratioTo(base, times);
    std::printf("%6d  %-18s %8.3f %8.3f  %5.2f (%4.2f-%4.2f) %6.1f  %8.1e%s\n", times.tetrahedra, times.law.c_str(),
                1e3 * step.median, 1e3 * step.p99, ratio.median, ratio.p1, ratio.p99, iterationsOf(times), times.error,
                times.flags == 0 ? "" : "  flags");
    std::fflush(stdout);
}

} // namespace

json benchLaws(bool quick)
{
    std::printf("instruction set %s, one thread, steps of %g ms; ratios as median (lowest-highest) of the repetitions\n"
                "error: of the displacement after %d steps, against a tolerance of 1e-5\n\n",
                engine::simdTargets().front().c_str(), 1e3 * kStep, kSteps);
    std::printf("%6s  %-18s %8s %8s  %17s %6s  %8s\n", "tets", "law", "step ms", "p99", "x corotational", "iter",
                "error");
    json cells = json::array();
    std::vector<Verdict> verdicts;
    for (const int tets : quick ? std::vector{756, 3004} : std::vector{756, 3004, 10000, 30000}) {
        const auto mesh = std::make_shared<const geometry::TetMesh>(
            geometry::loadTetMesh(runtime::asset(text("meshes/bunny_", tets, ".msh"))));
        const std::vector<LawTimes> all = measure(mesh, quick ? 5 : 9);
        for (const LawTimes& each : all) {
            print(all.front(), each);
            cells.push_back(toJson(all.front(), each));
        }
        const double ratio = ratioTo(all[0], all[1]).median;
        verdicts.push_back({text(tets, " tetrahedra: a neo-Hookean step takes at most 1.2 corotational ones"),
                            ratio <= 1.2, text(rounded(ratio, 100))});
    }
    return {{"bench", "laws"}, {"quick", quick}, {"cells", cells}, {"limits", printVerdicts(verdicts)}};
}

} // namespace filasofia::app
