#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/contact_run.h"
#include "apps/filasofia/bench/load.h"

#include "filasofia/core/text.h"
#include "filasofia/runtime/engines.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

// Scenes of bench contact with several engines behind one interface, each body with the same Def.
namespace filasofia::app {
namespace {

using nlohmann::json;
using runtime::Spread;

struct TouchCell {
    ContactScene scene = {};
    std::string engine = {};
    std::vector<double> costs = {};   ///< [s] processor time per step, after it has settled
    std::vector<double> found = {};   ///< [-] contacts per step
    std::vector<double> pushing = {}; ///< [-] those with a force
    std::vector<double> forces = {};  ///< [N] sum of normal forces per step
    double penetration = 0.0;         ///< [m] deepest, from the first step on
    int steps = 0, flagged = 0;       ///< all steps, and those with a flag
    [[nodiscard]] double force() const { return runtime::spreadOf(forces).median; }
};

/// A step of SOFA's takes long enough that bodies get half a second to settle, if a tool does not need more.
std::vector<ContactScene> scenes(bool quick)
{
    std::vector<ContactScene> all = {towerOfFive(), bunnyOnFloor(756), ballOnFloor()};
    if (!quick) all.push_back(bunnyOnFloor(3004));
    for (ContactScene& each : all) each.settle = 0.5;
    if (!quick) all.push_back(bunnyScraped(756, 0.1));
    return all;
}

TouchCell measure(const ContactScene& scene, const std::string& engine, bool quick)
{
    TouchCell cell{.scene = scene, .engine = engine};
    ContactRun run(scene, 1, true, engine);
    const int settle = static_cast<int>(std::lround(scene.settle / scene.step));
    const int counted = quick ? 50 : 100;
    for (int i = 0; i < settle + counted; ++i) {
        const double begin = secondsOf(CLOCK_THREAD_CPUTIME_ID);
        const physics::StepReport report = run.step();
        const double cost = secondsOf(CLOCK_THREAD_CPUTIME_ID) - begin;
        ++cell.steps;
        cell.flagged += report.flags != 0 ? 1 : 0;
        cell.penetration = std::max(cell.penetration, report.contacts.penetration);
        if (i < settle) continue;
        cell.costs.push_back(cost);
        cell.found.push_back(report.contacts.found);
        cell.pushing.push_back(report.contacts.active);
        cell.forces.push_back(pressedBy(run.capture()));
    }
    return cell;
}

json toJson(const TouchCell& cell)
{
    return {{"body", cell.scene.body},
            {"scene", cell.scene.name},
            {"tetrahedra", cell.scene.elements()},
            {"engine", cell.engine},
            {"step_cpu_s", spreadToJson(runtime::spreadOf(cell.costs))},
            {"found", spreadToJson(runtime::spreadOf(cell.found))},
            {"pushing", spreadToJson(runtime::spreadOf(cell.pushing))},
            {"force_n", spreadToJson(runtime::spreadOf(cell.forces))},
            {"penetration_m", cell.penetration},
            {"steps", cell.steps},
            {"steps_with_flags", cell.flagged}};
}

void print(const TouchCell& cell)
{
    const auto median = [](const std::vector<double>& values) { return runtime::spreadOf(values).median; };
    const Spread cost = runtime::spreadOf(cell.costs);
    std::printf("%-12s %-20s %6d  %-7s %9.3f %9.3f %6.0f %6.0f %9.4f %9.2f %5d of %d\n", cell.scene.body.c_str(),
                cell.scene.name.c_str(), cell.scene.elements(), cell.engine.c_str(), 1e3 * cost.median, 1e3 * cost.p99,
                median(cell.found), median(cell.pushing), cell.force(), 1e6 * cell.penetration, cell.flagged,
                cell.steps);
    std::fflush(stdout);
}

/// At rest the forces must carry the same weights, however contacts are found.
Verdict judge(const std::vector<TouchCell>& cells)
{
    Verdict verdict{.limit = "at rest the engines' contact forces add up to the same within 2 %",
                    .met = {},
                    .measured = "nothing was measured"};
    double worst = -1.0;
    for (std::size_t i = 1; i < cells.size(); ++i) {
        const TouchCell &mine = cells[i - 1], &other = cells[i];
        if (mine.scene.name != other.scene.name || mine.scene.body != other.scene.body || mine.scene.path) continue;
        const double apart = std::abs(other.force() / mine.force() - 1.0);
        if (!(apart > worst)) continue;
        worst = apart;
        verdict.met = worst <= 0.02;
        verdict.measured = text("largest difference ", worst, " (", mine.scene.body, ", ", mine.scene.name, ")");
    }
    return verdict;
}

} // namespace

json benchContactEngines(const std::string& other, bool quick)
{
    const std::vector<std::string> engines = {runtime::engineNames().front(), other};
    json info = json::array();
    for (const std::string& each : engines) // an engine that cannot be had ends here, before anything is measured
        info.push_back({{"name", each}, {"version", runtime::makeEngine(each, {})->info().version}});
    std::printf("steps of %g ms, one thread, its processor time; N: the sum of normal forces, median; deep: the "
                "deepest penetration from the "
                "first step on\n\n",
                1e3 * kContactStep);
    std::printf("%-12s %-20s %6s  %-7s %9s %9s %6s %6s %9s %9s %s\n", "body", "scene", "tets", "engine", "step ms",
                "p99 ms", "found", "push", "N", "deep um", "steps with flags");
    std::vector<TouchCell> cells;
    json all = json::array();
    for (const ContactScene& scene : scenes(quick))
        for (const std::string& engine : engines) {
            cells.push_back(measure(scene, engine, quick));
            print(cells.back());
            all.push_back(toJson(cells.back()));
        }
    return {{"bench", "contact_engines"},
            {"quick", quick},
            {"dt_s", kContactStep},
            {"engines", info},
            {"cells", all},
            {"limits", printVerdicts({judge(cells)})}};
}

} // namespace filasofia::app
