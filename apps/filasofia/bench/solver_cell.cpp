#include "apps/filasofia/bench/solver_cell.h"

#include "apps/filasofia/bench/load.h"
#include "apps/filasofia/bench/solver_run.h"
#include "filasofia/core/worker_pool.h"
#include "filasofia/runtime/clock.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

namespace filasofia::app {
namespace {

using runtime::Spread;

double median(const std::vector<double>& values) { return runtime::spreadOf(values).median; }

/// Keeps cores busy, as another program would, as long as it lives.
class Spinners {
public:
    explicit Spinners(int count)
    {
        for (int i = 0; i < count; ++i)
            threads_.emplace_back([this] {
                while (!done_.load(std::memory_order_relaxed)) {
                }
            });
    }
    ~Spinners() { done_ = true; }
    Spinners(const Spinners&) = delete;
    Spinners& operator=(const Spinners&) = delete;

private:
    std::atomic<bool> done_ = false;
    std::vector<std::jthread> threads_; // declared after the flag they read, so joined before it is destroyed
};

/// Alone on one core, on two cores, on all cores; then on one and on two while the other cores are busy.
std::vector<Crew> crews()
{
    const int cores = usableCores();
    std::vector<Crew> all{{1, false}};
    if (cores == 1) return all;
    all.push_back({2, false});
    if (cores > 2) all.push_back({cores, false});
    all.push_back({1, true});
    all.push_back({2, true});
    return all;
}

/// One crew's engine, kept from repetition to repetition.
struct Worker {
    CrewTimes times = {};
    std::unique_ptr<SolverRun> run = {};
    long iterations = 0;
};

void timeRun(Worker& worker, int steps, std::vector<double>& costs)
{
    const auto now = runtime::steadyClock().now;
    worker.run->backToRest();
    for (int i = 0; i < steps; ++i) {
        const runtime::Nanoseconds begun = now();
        const physics::StepReport report = worker.run->step();
        const runtime::Nanoseconds ended = now();
        worker.times.flags |= report.flags;
        if (i < kUncounted) continue;
        costs.push_back(1e-9 * static_cast<double>(ended - begun));
        worker.iterations += report.solves.front().iterations;
        worker.times.maxIterations = std::max(worker.times.maxIterations, report.solves.front().iterations);
    }
}

void repeat(const SolverMesh& mesh, double dt, const SolverEffort& effort, Worker& worker)
{
    const auto now = runtime::steadyClock().now;
    const Crew crew = worker.times.crew;
    const Spinners spinners(crew.othersBusy ? usableCores() - 1 : 0);
    if (!crew.othersBusy)
        worker.times.floors.push_back(
            testing::measureSolver(solverBunny(mesh.mesh, Hold::Head), {.gravity = kSolverGravity,
                                                                        .period = dt,
                                                                        .threads = crew.threads,
                                                                        .warmUp = kUncounted,
                                                                        .repeats = effort.floorRepeats,
                                                                        .now = now}));
    std::vector<double> costs;
    const OthersLoad others;
    const runtime::Nanoseconds enough = now() + runtime::toNanoseconds(effort.seconds);
    do timeRun(worker, effort.steps, costs);
    while (now() < enough);
    worker.times.others.push_back(others.cores());
    worker.times.medians.push_back(median(costs));
    worker.times.steps.insert(worker.times.steps.end(), costs.begin(), costs.end());
    worker.times.iterations = static_cast<double>(worker.iterations) / static_cast<double>(worker.times.steps.size());
}

/// States of the body at moments spread over a run.
std::vector<frame::SoftBodyFrame> moments(SolverRun& run, const SolverEffort& effort)
{
    std::vector<frame::SoftBodyFrame> all;
    run.backToRest();
    for (int i = 0; i < effort.steps; ++i) {
        const int next = static_cast<int>(all.size());
        const int room = effort.steps - kUncounted - effort.referenceSteps;
        if (next < effort.referenceWindows && i == kUncounted + room * next / effort.referenceWindows)
            all.push_back(run.state());
        run.step();
    }
    return all;
}

/// From each of these states: one step that is not counted, because it must find the rotations, then the counted steps.
void timeReference(const std::vector<frame::SoftBodyFrame>& from, int steps, ColdReference& reference, SolverCell& cell)
{
    std::vector<double> costs;
    for (const frame::SoftBodyFrame& moment : from)
        for (int i = 0; i <= steps; ++i) {
            const physics::StepReport report = reference.step(i == 0 ? &moment : nullptr);
            cell.referenceFlags |= report.flags & ~static_cast<std::uint32_t>(physics::StepFlag::Tuned);
            if (i > 0) costs.push_back(report.times.assemble + report.times.advance);
        }
    cell.referenceMedians.push_back(median(costs));
    cell.referenceSteps.insert(cell.referenceSteps.end(), costs.begin(), costs.end());
}

Spread ratios(const std::vector<double>& above, const std::vector<double>& below)
{
    std::vector<double> all;
    for (std::size_t r = 0; r < std::min(above.size(), below.size()); ++r) all.push_back(above[r] / below[r]);
    return runtime::spreadOf(all);
}

/// A run of which only the final state is used.
struct Job {
    std::unique_ptr<SolverRun> run = {};
    std::vector<Vec3> end = {};
    int maxIterations = 0;
    std::uint32_t flags = 0;
};

Job job(const physics::SoftBodyDef& def, double dt) { return {std::make_unique<SolverRun>(def, dt, 1)}; }

/// Runs the jobs on all cores, as nobody times them.
void finish(std::vector<Job>& jobs, int steps)
{
    WorkerPool pool(usableCores());
    pool.run(static_cast<int>(jobs.size()), [&](int j) {
        Job& each = jobs[static_cast<std::size_t>(j)];
        for (int i = 0; i < steps; ++i) {
            const physics::StepReport report = each.run->step();
            each.flags |= report.flags;
            each.maxIterations = std::max(each.maxIterations, report.solves.front().iterations);
        }
    });
    for (Job& each : jobs) each.end = each.run->state().positions;
}

} // namespace

Spread CrewTimes::floor() const
{
    std::vector<double> all;
    for (const testing::SolverCosts& costs : floors) all.push_back(costs.floor());
    return runtime::spreadOf(all);
}

Spread CrewTimes::overFloor() const
{
    std::vector<double> all;
    for (const testing::SolverCosts& costs : floors) all.push_back(costs.floor());
    return ratios(medians, all);
}

double CrewTimes::flopsPerSecond() const { return floors.empty() ? 0.0 : floors.front().flops / floor().median; }
double CrewTimes::floorPerElement() const { return floors.empty() ? 0.0 : floor().median / floors.front().elements; }

const CrewTimes* SolverCell::find(Crew crew) const
{
    const auto found = std::ranges::find(crews, crew, &CrewTimes::crew);
    return found == crews.end() ? nullptr : &*found;
}

Spread SolverCell::overReference() const { return ratios(referenceMedians, find({1, false})->medians); }

Spread SolverCell::speedUp(Crew crew) const { return ratios(find({1, crew.othersBusy})->medians, find(crew)->medians); }

std::optional<Spread> SolverCell::quietSpeedUp(Crew crew) const
{
    const CrewTimes &alone = *find({1, crew.othersBusy}), &many = *find(crew);
    std::vector<double> quiet;
    for (std::size_t r = 0; r < many.medians.size(); ++r)
        if (alone.others[r] <= kQuiet && many.others[r] <= kQuiet) quiet.push_back(alone.medians[r] / many.medians[r]);
    return quiet.empty() ? std::nullopt : std::optional(runtime::spreadOf(quiet));
}

SolverCell timeSolver(const SolverMesh& mesh, double dt, const SolverEffort& effort)
{
    SolverCell cell{.mesh = mesh, .dt = dt};
    std::vector<Worker> workers;
    const physics::SoftBodyDef def = solverBunny(mesh.mesh, Hold::Head);
    for (const Crew crew : crews())
        workers.push_back({{.crew = crew}, std::make_unique<SolverRun>(def, dt, crew.threads)});
    ColdReference reference(mesh.mesh, dt);
    const std::vector<frame::SoftBodyFrame> from = moments(*workers.front().run, effort);
    for (int r = 0; r < effort.repetitions; ++r) {
        for (Worker& worker : workers) repeat(mesh, dt, effort, worker);
        timeReference(from, effort.referenceSteps, reference, cell);
        if (usableCores() > 1) cell.roundTrips.push_back(coreRoundTrip());
    }
    for (Worker& worker : workers) cell.crews.push_back(std::move(worker.times));
    return cell;
}

std::vector<SolverErrors> solverErrors(const SolverMesh& mesh, int steps)
{
    const std::array<physics::ConjugateGradient, 3> solvers{
        {{.maxIterations = 100000, .tolerance = 1e-12, .assembled = true},
         {},
         {.maxIterations = 100000, .tolerance = kTightTolerance}}};
    std::vector<Job> jobs;
    for (const auto& solver : solvers) // the slow ones first
        for (double dt : kSolverSteps)
            for (Hold hold : {Hold::Head, Hold::Feet}) jobs.push_back(job(solverBunny(mesh.mesh, hold, solver), dt));
    finish(jobs, steps);

    std::vector<SolverErrors> all;
    constexpr std::size_t kPerSolver = 2 * kSolverSteps.size();
    for (std::size_t d = 0; d < kSolverSteps.size(); ++d) {
        SolverErrors errors{.steps = steps};
        for (std::size_t h = 0; h < 2; ++h) {
            const Job &exact = jobs[2 * d + h], &standard = jobs[kPerSolver + 2 * d + h],
                      &tight = jobs[2 * kPerSolver + 2 * d + h];
            const double displacement = distanceOf(exact.end, mesh.mesh->nodes);
            errors.standard[h] = distanceOf(standard.end, exact.end) / displacement;
            errors.tight[h] = distanceOf(tight.end, exact.end) / displacement;
            errors.flags |= exact.flags | standard.flags | tight.flags;
        }
        all.push_back(errors);
    }
    return all;
}

std::vector<StiffRun> stiffRuns(const SolverMesh& mesh, int steps)
{
    const std::array<physics::FemMaterial, 3> materials{{{.youngModulus = 1e6, .poissonRatio = 0.45},
                                                         {.youngModulus = 10e3, .poissonRatio = 0.49},
                                                         {.youngModulus = 1e6, .poissonRatio = 0.49}}};
    std::vector<Job> jobs;
    std::vector<StiffRun> all;
    for (double dt : kSolverSteps)
        for (const physics::FemMaterial& material : materials) {
            jobs.push_back(job(solverBunny(mesh.mesh, Hold::Head, physics::ConjugateGradient{}, material), dt));
            all.push_back({mesh.name, dt, material.youngModulus, material.poissonRatio});
        }
    finish(jobs, steps);
    for (std::size_t j = 0; j < jobs.size(); ++j) {
        all[j].maxIterations = jobs[j].maxIterations;
        all[j].flags = jobs[j].flags;
    }
    return all;
}

} // namespace filasofia::app
