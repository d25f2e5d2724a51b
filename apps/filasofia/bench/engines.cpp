#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/load.h"
#include "apps/filasofia/bench/solver_run.h"

#include "filasofia/filasofia.h"
#include "filasofia/runtime/engines.h"

#include <cmath>
#include <cstdio>
#include <optional>

// The paper's figure 6 with several engines: the bunny that is pinned at the head falls under its own weight, and every
// engine's cost of a step stands beside its error against the converged solution of its own equations. Engines make a
// step from different tangents, so their converged solutions differ, by an amount that is shown too.
namespace filasofia::app {
namespace {

using nlohmann::json;

constexpr double kStep = 5e-3; ///< [s] the paper's
constexpr int kSteps = 100;    ///< half a second: it falls, and swings back
constexpr int kQuickSteps = 20;
constexpr int kLargestDirect = 10000; ///< tetrahedra; beyond, a factorisation per step takes minutes
constexpr int kCompareEvery = 10;     ///< [-] steps between two comparisons

/// How an engine solves the step.
struct Way {
    const char* name;
    physics::Solver solver;
};
const Way kWays[] = {{"cg 5e-3", ConjugateGradient{.tolerance = 5e-3}},
                     {"cg 5e-4", ConjugateGradient{.maxIterations = 3000, .tolerance = 5e-4}},
                     {"cg 1e-5", ConjugateGradient{.maxIterations = 3000, .tolerance = 1e-5}},
                     {"assembled 5e-4", ConjugateGradient{.maxIterations = 3000, .tolerance = 5e-4, .assembled = true}},
                     {"direct", Cholesky{}}};

/// One run of the bunny.
struct Fall {
    std::vector<double> costs = {};           ///< [s] processor time per step: other programs count little
    std::vector<std::vector<Vec3>> seen = {}; ///< positions, every kCompareEvery steps
    double iterations = 0.0;                  ///< [-] per step, mean
    std::uint32_t flags = 0;
};

Fall fall(physics::PhysicsEngine& engine, const physics::SoftBodyDef& def, int steps)
{
    const auto shared = std::make_shared<const physics::BodyDef>(def);
    std::vector<physics::Command> commands;
    commands.emplace_back(physics::SetGravity{kSolverGravity});
    commands.emplace_back(physics::AddBody{BodyId{1}, shared, engine.build(*shared)});
    engine.step({.dt = 0.0, .commands = commands});
    Fall out;
    for (int i = 1; i <= steps; ++i) {
        const double begin = secondsOf(CLOCK_THREAD_CPUTIME_ID);
        const physics::StepReport report = engine.step({.dt = kStep});
        out.costs.push_back(secondsOf(CLOCK_THREAD_CPUTIME_ID) - begin);
        out.iterations += static_cast<double>(report.iterations()) / steps;
        out.flags |= report.flags;
        if (i % kCompareEvery != 0) continue;
        frame::Frame frame;
        engine.capture(frame);
        out.seen.push_back(std::move(frame.softBodies.front().positions));
    }
    return out;
}

/// [-] The largest distance to the reference, relative to the reference's own way from rest, over the comparisons.
double errorOf(const Fall& run, const Fall& reference, const std::vector<Vec3>& rest)
{
    double worst = 0.0;
    for (std::size_t i = 0; i < run.seen.size(); ++i)
        worst = std::max(worst, distanceOf(run.seen[i], reference.seen[i]) / distanceOf(reference.seen[i], rest));
    return worst;
}

struct EngineCell {
    int tets = 0;
    std::string engine = {}, way = {};
    double error = 0.0; ///< [-] against the engine's own converged solution
    double apart = 0.0; ///< [-] between the engine's converged solution and the native one
    Fall run = {};
};

json toJson(const EngineCell& cell)
{
    return {{"tets", cell.tets},
            {"engine", cell.engine},
            {"solver", cell.way},
            {"step_cpu_s", spreadToJson(runtime::spreadOf(cell.run.costs))},
            {"iterations", cell.run.iterations},
            {"flags", cell.run.flags},
            {"error", cell.error},
            {"apart", cell.apart}};
}

void print(const EngineCell& cell)
{
    const runtime::Spread cost = runtime::spreadOf(cell.run.costs);
    std::printf("%6d  %-7s  %-14s  %9.3f %9.3f  %8.1f  %9.2e  %9.2e%s\n", cell.tets, cell.engine.c_str(),
                cell.way.c_str(), 1e3 * cost.median, 1e3 * cost.p99, cell.run.iterations, cell.error, cell.apart,
                cell.run.flags == 0 ? "" : "  flags");
    std::fflush(stdout);
}

/// One mesh with every engine and solver.
void measureMesh(int tets, int steps, const std::vector<std::string>& engines, std::vector<EngineCell>& cells)
{
    const auto mesh = std::make_shared<const TetMesh>(loadTetMesh(asset(text("meshes/bunny_", tets, ".msh"))));
    const FemMaterial material{.youngModulus = 10e3, .poissonRatio = 0.45, .law = Corotational{}};
    const auto run = [&](const std::string& engine, const physics::Solver& solver) {
        const auto made = runtime::makeEngine(engine, {.period = kStep, .threads = 1});
        return fall(*made, solverBunny(mesh, Hold::Head, solver, material), steps);
    };
    const ConjugateGradient tightest{.maxIterations = 100000, .tolerance = 1e-9, .assembled = true};
    std::optional<Fall> native;
    for (const std::string& engine : engines) {
        const Fall converged = run(engine, tightest);
        if (!native) native = converged;
        for (const Way& way : kWays) {
            if (std::holds_alternative<Cholesky>(way.solver) && tets > kLargestDirect) continue;
            EngineCell& cell = cells.emplace_back(EngineCell{.tets = tets, .engine = engine, .way = way.name});
            cell.run = run(engine, way.solver);
            cell.error = errorOf(cell.run, converged, mesh->nodes);
            cell.apart = errorOf(converged, *native, mesh->nodes);
            print(cell);
        }
    }
}

std::vector<Verdict> judge(const std::vector<EngineCell>& cells)
{
    Verdict verdict{.limit = "every engine's direct solver ends within 1e-5 of its conjugate gradients at 1e-9",
                    .met = {},
                    .measured = "nothing was measured"};
    double worst = -1.0;
    for (const EngineCell& cell : cells)
        if (cell.way == "direct" && cell.error > worst) {
            worst = cell.error;
            verdict.met = worst <= 1e-5;
            verdict.measured = text("largest ", worst, " (", cell.engine, ", ", cell.tets, " tetrahedra)");
        }
    return {verdict};
}

} // namespace

json benchEngines(const std::string& other, bool quick)
{
    const std::vector<std::string> engines = {runtime::engineNames().front(), other};
    json info = json::array();
    for (const std::string& each : engines) // an engine that cannot be had ends here, before anything is measured
        info.push_back({{"name", each}, {"version", runtime::makeEngine(each, {})->info().version}});
    const std::vector<int> sizes = quick ? std::vector{756} : std::vector{756, 1492, 3004, 10000, 30000};
    std::printf("the bunny, corotational law, pinned at the head, steps of %g ms, one thread, its processor time\n"
                "error: the largest distance to the same engine's converged solution, relative to that solution's "
                "displacement\n"
                "apart: that of the engine's converged solution to the native one\n\n",
                1e3 * kStep);
    std::printf("%6s  %-7s  %-14s  %9s %9s  %8s  %9s  %9s\n", "tets", "engine", "solver", "step ms", "p99 ms", "iter",
                "error", "apart");
    std::vector<EngineCell> cells;
    for (const int tets : sizes) measureMesh(tets, quick ? kQuickSteps : kSteps, engines, cells);
    json all = json::array();
    for (const EngineCell& cell : cells) all.push_back(toJson(cell));
    return {{"bench", "engines"},
            {"quick", quick},
            {"dt_s", kStep},
            {"steps", quick ? kQuickSteps : kSteps},
            {"engines", info},
            {"cells", all},
            {"limits", printVerdicts(judge(cells))}};
}

} // namespace filasofia::app
