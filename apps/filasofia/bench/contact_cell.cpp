#include "apps/filasofia/bench/contact_cell.h"

#include "apps/filasofia/bench/load.h"
#include "filasofia/core/worker_pool.h"
#include "filasofia/runtime/clock.h"

#include <algorithm>
#include <cmath>

namespace filasofia::app {
namespace {

/// A run and its results so far.
struct ContactWorker {
    ContactTimes times = {};
    std::unique_ptr<ContactRun> run = {};
    double iterations = 0.0;
};

void look(const physics::StepReport& report, ContactRun& run, ContactCell& cell)
{
    cell.found.push_back(report.contacts.found);
    cell.pushing.push_back(report.contacts.active);
    cell.rounds.push_back(report.contacts.rounds);
    cell.mismatches.push_back(report.contacts.mismatch);
    cell.forces.push_back(pressedBy(run.capture()));
}

/// If `cell` is given, the contacts of the run are recorded there too.
void repeat(int steps, ContactWorker& worker, ContactCell* cell)
{
    const auto now = runtime::steadyClock().now;
    const physics::StepBudget budget{.now = now};
    std::vector<double> costs;
    const OthersLoad others;
    for (int i = 0; i < steps; ++i) {
        const runtime::Nanoseconds begun = now();
        const physics::StepReport report = worker.run->step(&budget);
        costs.push_back(1e-9 * static_cast<double>(now() - begun));
        worker.times.detections.push_back(report.times.contacts);
        worker.times.responses.push_back(costs.back() - report.times.contacts);
        worker.times.flags |= report.flags;
        worker.times.flagged += report.flags != 0 ? 1 : 0;
        worker.iterations += iterationsOf(report);
        if (!cell) continue;
        cell->penetration = std::max(cell->penetration, report.contacts.penetration);
        look(report, *worker.run, *cell);
    }
    worker.times.others.push_back(others.cores());
    worker.times.medians.push_back(runtime::spreadOf(costs).median);
    worker.times.steps.insert(worker.times.steps.end(), costs.begin(), costs.end());
    worker.times.iterations = worker.iterations / static_cast<double>(worker.times.steps.size());
}

} // namespace

runtime::Spread ContactCell::overFree() const
{
    std::vector<double> all;
    for (std::size_t r = 0; r < alone().medians.size(); ++r) all.push_back(alone().medians[r] / free().medians[r]);
    return runtime::spreadOf(all);
}

ContactCell timeContact(const ContactScene& scene, const ContactEffort& effort)
{
    ContactCell cell{.scene = scene, .elements = scene.elements()};
    std::vector<ContactWorker> workers;
    const int cores = usableCores();
    for (const auto& [threads, contacts] : {std::pair{1, true}, {1, false}, {cores, true}})
        if (threads > 1 || workers.size() < 2)
            workers.push_back(
                {{.threads = threads, .contacts = contacts}, std::make_unique<ContactRun>(scene, threads, contacts)});
    for (ContactWorker& worker : workers)
        for (int i = 0; i < static_cast<int>(std::lround(scene.settle / scene.step)); ++i) {
            const physics::StepReport report = worker.run->step();
            worker.times.flags |= report.flags;
            if (&worker == &workers.front()) cell.penetration = std::max(cell.penetration, report.contacts.penetration);
        }
    for (int r = 0; r < effort.repetitions; ++r)
        for (ContactWorker& worker : workers)
            repeat(effort.steps, worker, &worker == &workers.front() ? &cell : nullptr);
    for (ContactWorker& worker : workers) cell.runs.push_back(std::move(worker.times));
    return cell;
}

} // namespace filasofia::app
