#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/load.h"
#include "apps/filasofia/bench/solver_limits.h"
#include "apps/filasofia/bench/solver_run.h"
#include "filasofia/core/text.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/runtime/clock.h"

#include <algorithm>
#include <cstdio>

namespace filasofia::app {
namespace {

using nlohmann::json;
using physics::ElasticLaw;
using physics::FemMaterial;
using Mesh = std::shared_ptr<const geometry::TetMesh>;

constexpr double kStep = 5e-3;            ///< [s]
constexpr int kSteps = 100;               ///< for one run from rest, in which the bunny falls and swings
constexpr int kWarmUp = 10;               ///< steps of a run that are not timed
constexpr double kOverCorotational = 1.2; ///< [-] a neo-Hookean step at most
constexpr double kOverCompressible = 1.5; ///< [-] one at a Poisson ratio of 0.4999 at most, over one at 0.45

/// The materials with the laws' defaults, the corotational one first: the others are compared with it.
std::vector<FemMaterial> laws()
{
    std::vector<FemMaterial> all;
    for (const ElasticLaw& law : physics::elasticLaws())
        all.push_back({.youngModulus = 10e3, .poissonRatio = 0.45, .law = law});
    std::stable_partition(all.begin(), all.end(), [](const FemMaterial& material) {
        return std::holds_alternative<physics::Corotational>(material.law);
    });
    return all;
}

/// The default law from a Poisson ratio of 0.45 on, with which the others are compared.
std::vector<FemMaterial> nearlyIncompressible()
{
    std::vector<FemMaterial> all;
    for (const double ratio : {0.45, 0.49, 0.499, 0.4999}) all.push_back({.youngModulus = 10e3, .poissonRatio = ratio});
    return all;
}

/// One material on one mesh.
struct MaterialTimes {
    FemMaterial material = {};
    int tetrahedra = 0;
    std::vector<double> steps = {};   ///< [s] processor time, in all repetitions
    std::vector<double> medians = {}; ///< [s] one per repetition
    long iterations = 0;
    std::uint32_t flags = 0;
    double error = 0.0; ///< [-] in the displacement after a run, relative to it

    [[nodiscard]] std::string law() const { return std::string(physics::nameOf(material.law)); }
};

/// Where the nodes are after a run from rest.
std::vector<Vec3> endOf(const Mesh& mesh, const FemMaterial& material, const physics::Solver& solver)
{
    SolverRun run(solverBunny(mesh, Hold::Head, solver, material), kStep, 1);
    for (int i = 0; i < kSteps; ++i) run.step();
    return run.state().positions;
}

void repeat(SolverRun& run, MaterialTimes& times)
{
    std::vector<double> costs;
    run.backToRest();
    for (int i = 0; i < kSteps; ++i) {
        const double begun = secondsOf(CLOCK_THREAD_CPUTIME_ID);
        const physics::StepReport report = run.step();
        const double ended = secondsOf(CLOCK_THREAD_CPUTIME_ID);
        times.flags |= report.flags;
        if (i < kWarmUp) continue;
        costs.push_back(ended - begun);
        times.iterations += report.solves.front().iterations;
    }
    times.medians.push_back(runtime::spreadOf(costs).median);
    times.steps.insert(times.steps.end(), costs.begin(), costs.end());
}

/// Times all materials on a mesh in turns, so that a slow minute of the machine slows all alike.
std::vector<MaterialTimes> measure(const Mesh& mesh, const std::vector<FemMaterial>& materials, int repetitions)
{
    const physics::ConjugateGradient tight{.maxIterations = 100000, .tolerance = 1e-5};
    std::vector<MaterialTimes> all;
    std::vector<std::unique_ptr<SolverRun>> runs;
    for (const FemMaterial& material : materials) {
        MaterialTimes times{.material = material, .tetrahedra = static_cast<int>(mesh->tetrahedra.size())};
        const std::vector<Vec3> exact = endOf(mesh, material, tight);
        const std::vector<Vec3> found = endOf(mesh, material, physics::ConjugateGradient{});
        times.error = distanceOf(found, exact) / distanceOf(exact, mesh->nodes);
        all.push_back(std::move(times));
        runs.push_back(std::make_unique<SolverRun>(
            solverBunny(mesh, Hold::Head, physics::ConjugateGradient{}, material), kStep, 1));
    }
    for (int i = 0; i < repetitions; ++i)
        for (std::size_t l = 0; l < runs.size(); ++l) repeat(*runs[l], all[l]);
    return all;
}

runtime::Spread ratioTo(const MaterialTimes& base, const MaterialTimes& times)
{
    std::vector<double> ratios;
    for (std::size_t i = 0; i < times.medians.size(); ++i) ratios.push_back(times.medians[i] / base.medians[i]);
    return runtime::spreadOf(ratios);
}

double iterationsOf(const MaterialTimes& times)
{
    return static_cast<double>(times.iterations) / static_cast<double>(times.steps.size());
}

/// `over`: the name of the ratio to `base`.
json toJson(const MaterialTimes& base, const MaterialTimes& times, const char* over)
{
    return {{"law", times.law()},
            {"poisson_ratio", times.material.poissonRatio},
            {"tetrahedra", times.tetrahedra},
            {"dt_s", kStep},
            {"step_s", spreadToJson(runtime::spreadOf(times.steps))},
            {over, spreadToJson(ratioTo(base, times))},
            {"iterations_mean", iterationsOf(times)},
            {"error", times.error},
            {"flags", times.flags}};
}

void print(const MaterialTimes& base, const MaterialTimes& times)
{
    const runtime::Spread step = runtime::spreadOf(times.steps), ratio = ratioTo(base, times);
    std::printf("%6d  %-18s %-6g %8.3f %8.3f  %5.2f (%4.2f-%4.2f) %6.1f  %8.1e%s\n", times.tetrahedra,
                times.law().c_str(), times.material.poissonRatio, 1e3 * step.median, 1e3 * step.p99, ratio.median,
                ratio.p1, ratio.p99, iterationsOf(times), times.error, times.flags == 0 ? "" : "  flags");
    std::fflush(stdout);
}

void printHead()
{
    std::printf("instruction set %s, one thread, processor time, steps of %g ms; ratios as median (lowest-highest) of "
                "the repetitions, over the first row of a mesh\n"
                "error: of the displacement after %d steps, against a tolerance of 1e-5\n\n",
                engine::simdTargets().front().c_str(), 1e3 * kStep, kSteps);
    std::printf("%6s  %-18s %-6s %8s %8s  %17s %6s  %8s\n", "tets", "law", "nu", "step ms", "p99", "x first", "iter",
                "error");
}

/// What is written of the benches of one list of materials.
struct Written {
    json cells = json::array();
    std::vector<Verdict> verdicts = {};
};

/// [s] The lower bound of a step at 3004 tetrahedra, per tetrahedron.
double floorPerElement()
{
    const testing::SolverCosts costs = testing::measureSolver(
        solverBunny(bunnyMesh(3004), Hold::Head),
        {.gravity = kSolverGravity, .period = kStep, .threads = 1, .warmUp = kUncounted, .repeats = 100, .now = [] {
             return static_cast<std::int64_t>(1e9 * secondsOf(CLOCK_THREAD_CPUTIME_ID));
         }});
    return costs.floor() / costs.elements;
}

void benchLaws(const std::vector<int>& sizes, int repetitions, double floor, Written& out)
{
    for (const int tets : sizes) {
        // Steps of the largest mesh take so long that few of them are needed.
        const std::vector<MaterialTimes> all =
            measure(bunnyMesh(tets), laws(), tets == kLargestBunny ? 3 : repetitions);
        std::vector<Measured> steps;
        for (const MaterialTimes& each : all) {
            print(all.front(), each);
            out.cells.push_back(toJson(all.front(), each, "over_corotational"));
            steps.push_back({runtime::spreadOf(each.steps).median, each.law()});
        }
        const double ratio = ratioTo(all[0], all[1]).median;
        out.verdicts.push_back(
            {text(tets, " tetrahedra: a neo-Hookean step takes at most ", kOverCorotational, " corotational ones"),
             ratio <= kOverCorotational, text(rounded(ratio, 100))});
        for (const StepLimit& limit : kStepLimits)
            if (limit.mesh == text(tets)) out.verdicts.push_back(judgeSteps(steps, limit, floor));
    }
}

void benchIncompressible(const std::vector<int>& sizes, int repetitions, Written& out)
{
    for (const int tets : sizes) {
        const std::vector<MaterialTimes> all = measure(bunnyMesh(tets), nearlyIncompressible(), repetitions);
        for (const MaterialTimes& each : all) {
            print(all.front(), each);
            out.cells.push_back(toJson(all.front(), each, "over_045"));
        }
        const double ratio = ratioTo(all.front(), all.back()).median;
        out.verdicts.push_back({text(tets, " tetrahedra: a step at a Poisson ratio of 0.4999 takes at most ",
                                     kOverCompressible, " of those at 0.45"),
                                ratio <= kOverCompressible, text(rounded(ratio, 10))});
    }
}

} // namespace

json benchLaws(bool quick)
{
    const int repetitions = quick ? 5 : 9;
    printHead();
    Written byLaw, byRatio;
    benchLaws(quick ? std::vector{756, 3004} : std::vector{756, 3004, 10000, 30000, kLargestBunny}, repetitions,
              floorPerElement(), byLaw);
    benchIncompressible(quick ? std::vector{756} : std::vector{756, 3004, 10000}, repetitions, byRatio);
    std::vector<Verdict> verdicts = std::move(byLaw.verdicts);
    verdicts.insert(verdicts.end(), byRatio.verdicts.begin(), byRatio.verdicts.end());
    return {{"bench", "laws"},
            {"quick", quick},
            {"cells", byLaw.cells},
            {"incompressible", byRatio.cells},
            {"limits", printVerdicts(verdicts)}};
}

} // namespace filasofia::app
