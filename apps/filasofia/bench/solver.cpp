#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/solver_limits.h"
#include "apps/filasofia/bench/solver_run.h"
#include "filasofia/core/text.h"
#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/native_engine.h"

#include <cstdio>

namespace filasofia::app {
namespace {

using nlohmann::json;
using runtime::Spread;

/// A mesh of the table and the amount of measurement on it.
struct Row {
    SolverMesh mesh;
    SolverEffort effort;
};

SolverMesh meshOf(int tets) { return {text(tets), bunnyMesh(tets), tets != kLargestBunny}; }

/// The reference solver takes seconds per step on the largest mesh, so fewer steps are made there.
std::vector<Row> table(bool quick)
{
    std::vector<Row> rows;
    const SolverEffort small{.steps = 60,
                             .errorSteps = 200,
                             .stiffSteps = 20,
                             .repetitions = 3,
                             .seconds = 0.05,
                             .floorRepeats = 50,
                             .referenceWindows = 2,
                             .referenceSteps = 2};
    for (int tets : {756, 1492, 3004}) rows.push_back({meshOf(tets), quick ? small : SolverEffort{}});
    if (quick) return rows;
    rows.push_back({meshOf(10000), {}});
    rows.push_back({meshOf(30000), {.referenceWindows = 4, .referenceSteps = 2}});
    rows.push_back({meshOf(kLargestBunny),
                    {.errorSteps = 20,
                     .stiffSteps = 0,
                     .repetitions = 5,
                     .floorRepeats = 30,
                     .referenceWindows = 1,
                     .referenceSteps = 2}});
    return rows;
}

json toJson(const CrewTimes& times, const SolverCell& cell)
{
    json all = {{"threads", times.crew.threads},
                {"other_cores_busy", times.crew.othersBusy},
                {"step_s", spreadToJson(times.step())},
                {"steps_counted", times.steps.size()},
                {"step_medians_s", times.medians},
                {"steps_per_s", 1.0 / times.step().median},
                {"iterations_mean", times.iterations},
                {"iterations_most", times.maxIterations},
                {"flags", times.flags},
                {"cores_taken_by_others", times.others}};
    if (times.crew.threads > 1) all["times_as_fast_as_one_thread"] = spreadToJson(cell.speedUp(times.crew));
    if (times.floors.empty()) return all;
    json parts = json::array();
    for (const testing::SolverCosts& costs : times.floors)
        parts.push_back({{"element_pass_s", costs.elementPass},
                         {"product_s", costs.product},
                         {"preconditioner_s", costs.preconditioner}});
    all.update({{"floor_s", spreadToJson(times.floor())},
                {"floor_parts", parts},
                {"step_over_floor", spreadToJson(times.overFloor())},
                {"floor_ns_per_tetrahedron", 1e9 * times.floorPerElement()},
                {"floor_gflop_per_s", 1e-9 * times.flopsPerSecond()}});
    return all;
}

json toJson(const SolverCell& cell)
{
    json crews = json::array();
    for (const CrewTimes& times : cell.crews) crews.push_back(toJson(times, cell));
    return {{"mesh", cell.mesh.name},
            {"tetrahedra", cell.mesh.elements()},
            {"nodes", cell.mesh.mesh->nodes.size()},
            {"coarse_nodes", cell.crews.front().floors.front().coarseNodes},
            {"dt_s", cell.dt},
            {"runs", crews},
            {"oracle_step_s", spreadToJson(runtime::spreadOf(cell.referenceSteps))},
            {"oracle_steps_counted", cell.referenceSteps.size()},
            {"core_round_trip_s", cell.roundTrips},
            {"oracle_over_step", spreadToJson(cell.overReference())},
            {"error",
             {{"steps", cell.errors.steps},
              {"hanging", cell.errors.standard[0]},
              {"standing", cell.errors.standard[1]},
              {"hanging_tight", cell.errors.tight[0]},
              {"standing_tight", cell.errors.tight[1]},
              {"tight_tolerance", kTightTolerance}}}};
}

json toJson(const StiffRun& run)
{
    return {{"mesh", run.mesh},
            {"dt_s", run.dt},
            {"young_modulus_pa", run.youngModulus},
            {"poisson_ratio", run.poissonRatio},
            {"iterations_most", run.maxIterations},
            {"flags", run.flags}};
}

void printHead(const std::string& simd)
{
    std::printf("instruction set %s, %d cores; a step's median and 99th percentile, the other columns as median "
                "(lowest-highest) over the repetitions\n",
                simd.c_str(), usableCores());
    std::printf("x floor: time of a step / lower bound (one element pass, two products, one preconditioner); x ref: "
                "time of the "
                "reference solver (assembled, double precision, tolerance 1e-6, no warm start) / time of a step\n");
    std::printf(
        "error: relative to the displacement, the worse of hanging and standing, at the default tolerance and at %g\n",
        kTightTolerance);
    std::printf("others: cores used by other programs; trip: a signal between two cores and back\n\n");
    std::printf("%6s %2s %-7s %7s %7s %7s %5s %8s %16s %6s %7s %19s %16s %6s %7s %8s %8s\n", "tets", "ms", "threads",
                "step ms", "p99", "steps/s", "iter", "floor ms", "x floor", "ns/tet", "GFLOP/s", "x ref", "x 1 thread",
                "others", "trip ns", "error", "tight");
}

std::string written(const Spread& s)
{
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, "%.2f (%.2f-%.2f)", s.median, s.p1, s.p99);
    return buffer;
}

void print(const SolverCell& cell, const CrewTimes& times)
{
    const Spread step = times.step();
    std::printf("%6s %2g %d %-5s %7.3f %7.3f %7.0f %5.1f ", cell.mesh.name.c_str(), 1e3 * cell.dt, times.crew.threads,
                times.crew.othersBusy ? "busy" : "", 1e3 * step.median, 1e3 * step.p99, 1.0 / step.median,
                times.iterations);
    if (times.floors.empty())
        std::printf("%8s %16s %6s %7s ", "", "", "", "");
    else
        std::printf("%8.3f %16s %6.1f %7.1f ", 1e3 * times.floor().median, written(times.overFloor()).c_str(),
                    1e9 * times.floorPerElement(), 1e-9 * times.flopsPerSecond());
    const bool alone = times.crew == Crew{1, false}, many = times.crew.threads > 1;
    std::printf("%19s %16s %6.2f", alone ? written(cell.overReference()).c_str() : "",
                many ? written(cell.speedUp(times.crew)).c_str() : "", runtime::spreadOf(times.others).median);
    if (alone)
        std::printf(" %7s %8.1e %8.1e", "", std::max(cell.errors.standard[0], cell.errors.standard[1]),
                    std::max(cell.errors.tight[0], cell.errors.tight[1]));
    else if (!times.crew.othersBusy)
        std::printf(" %7.0f", 1e9 * cell.roundTrip().median);
    std::printf("\n");
}

std::vector<SolverCell> measure(const Row& row)
{
    const std::vector<SolverErrors> errors = solverErrors(row.mesh, row.effort.errorSteps);
    std::vector<SolverCell> cells;
    for (std::size_t d = 0; d < kSolverSteps.size(); ++d) {
        cells.push_back(timeSolver(row.mesh, kSolverSteps[d], row.effort));
        cells.back().errors = errors[d];
        for (const CrewTimes& times : cells.back().crews) print(cells.back(), times);
        std::fflush(stdout);
    }
    return cells;
}

template <class List> json listOf(const List& list)
{
    json all = json::array();
    for (const auto& each : list) all.push_back(toJson(each));
    return all;
}

} // namespace

json benchSolver(bool quick)
{
    const std::vector<std::string> simd = engine::simdTargets();
    printHead(simd.front());
    std::vector<SolverCell> cells;
    std::vector<StiffRun> stiff;
    for (const Row& row : table(quick)) {
        for (SolverCell& cell : measure(row)) cells.push_back(std::move(cell));
        if (row.effort.stiffSteps == 0) continue;
        for (StiffRun& run : stiffRuns(row.mesh, row.effort.stiffSteps)) stiff.push_back(std::move(run));
    }
    return {{"bench", "solver"},
            {"quick", quick},
            {"cores", usableCores()},
            {"simd_targets", simd},
            {"cells", listOf(cells)},
            {"stiff", listOf(stiff)},
            {"limits", printVerdicts(judgeSolver(cells, stiff, simd.front()))}};
}

} // namespace filasofia::app
