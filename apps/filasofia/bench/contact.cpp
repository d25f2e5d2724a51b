#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/contact_limits.h"
#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/native_engine.h"

#include <algorithm>
#include <cstdio>

namespace filasofia::app {
namespace {

using nlohmann::json;
using runtime::Spread;

std::vector<ContactScene> table(bool quick)
{
    std::vector<ContactScene> scenes;
    for (int tets : {3004, 10000, 30000}) {
        if (quick && tets > 3004) break;
        scenes.push_back(bunnyOnFloor(tets));
        for (double speed : {0.1, 1.0}) scenes.push_back(bunnyScraped(tets, speed));
    }
    for (int contacts : {10, 30, 100, 300, 1000})
        if (!quick) scenes.push_back(plateOnSlab(contacts));
    scenes.push_back(blockOnBlock());
    scenes.push_back(towerOfFive());
    scenes.push_back(boxesAtRest());
    for (double stiffness : {100.0, 400.0}) scenes.push_back(gripAtRest(stiffness));
    if (!quick) scenes.push_back(softHeap());
    for (double stiffness : {60.0, physics::kHard}) scenes.push_back(tiedBlocks(stiffness));
    return scenes;
}

double highest(const std::vector<double>& values) { return values.empty() ? 0.0 : std::ranges::max(values); }

json distribution(const std::vector<double>& values)
{
    json all = spreadToJson(runtime::spreadOf(values));
    all["max"] = highest(values);
    return all;
}

json toJson(const ContactTimes& run)
{
    return {{"threads", run.threads},
            {"contacts", run.contacts},
            {"step_s", distribution(run.steps)},
            {"detection_s", distribution(run.detections)},
            {"response_s", distribution(run.responses)},
            {"step_medians_s", run.medians},
            {"steps_counted", run.steps.size()},
            {"iterations_mean", run.iterations},
            {"flags", run.flags},
            {"steps_with_flags", run.flagged},
            {"cores_taken_by_others", run.others}};
}

json toJson(const ContactCell& cell)
{
    json runs = json::array();
    for (const ContactTimes& run : cell.runs) runs.push_back(toJson(run));
    return {{"body", cell.scene.body},
            {"scene", cell.scene.name},
            {"dt_s", cell.scene.step},
            {"tetrahedra", cell.elements},
            {"contacts_asked", cell.scene.asked},
            {"found", distribution(cell.found)},
            {"pushing", distribution(cell.pushing)},
            {"rounds", distribution(cell.rounds)},
            {"mismatch", distribution(cell.mismatches)},
            {"force_n", distribution(cell.forces)},
            {"penetration_m", cell.penetration},
            {"step_over_contact_free", spreadToJson(cell.overFree())},
            {"runs", runs}};
}

void printHead()
{
    std::printf("instruction set %s, %d cores, steps of %g ms (the heap: 5 ms); detection: finding the contacts; "
                "response: the rest of the step\n",
                engine::simdTargets().front().c_str(), usableCores(), 1e3 * kContactStep);
    std::printf("x free: cost relative to a step of the same bodies without contact, median (lowest-highest) over "
                "the repetitions; others: cores used by other programs\n\n");
    std::printf("%-12s %-20s %6s %3s %8s %8s %8s %8s %8s %18s %6s %6s %6s %7s %8s %9s %6s\n", "body", "scene", "tets",
                "thr", "step ms", "p99", "max", "detect", "respond", "x free", "found", "push", "rounds", "iter", "N",
                "deep um", "others");
}

void print(const ContactCell& cell)
{
    for (const ContactTimes& run : cell.runs) {
        const Spread step = run.step(), ratio = cell.overFree();
        char over[64] = "";
        if (run.contacts && run.threads == 1)
            std::snprintf(over, sizeof over, "%.2f (%.2f-%.2f)", ratio.median, ratio.p1, ratio.p99);
        std::printf("%-12s %-20s %6d %3d %8.3f %8.3f %8.3f %8.3f %8.3f %18s ", cell.scene.body.c_str(),
                    run.contacts ? cell.scene.name.c_str() : "contact-free", cell.elements, run.threads,
                    1e3 * step.median, 1e3 * step.p99, 1e3 * highest(run.steps),
                    1e3 * runtime::spreadOf(run.detections).median, 1e3 * runtime::spreadOf(run.responses).median,
                    over);
        const auto median = [](const std::vector<double>& values) { return runtime::spreadOf(values).median; };
        if (run.contacts)
            std::printf("%6.0f %6.0f %6.0f %7.1f %8.3f %9.2f", median(cell.found), median(cell.pushing),
                        median(cell.rounds), run.iterations, median(cell.forces), 1e6 * cell.penetration);
        else
            std::printf("%6s %6s %6s %7.1f %8s %9s", "", "", "", run.iterations, "", "");
        std::printf(" %6.2f%s\n", median(run.others), run.flags == 0 ? "" : "  flags");
    }
    std::fflush(stdout);
}

} // namespace

json benchContact(bool quick, const std::string& only)
{
    printHead();
    const ContactEffort effort = quick ? ContactEffort{.repetitions = 3, .steps = 60} : ContactEffort{};
    std::vector<ContactCell> cells;
    json all = json::array();
    for (const ContactScene& scene : table(quick)) {
        if (scene.label().find(only) == std::string::npos) continue;
        cells.push_back(timeContact(scene, effort));
        print(cells.back());
        all.push_back(toJson(cells.back()));
    }
    return {{"bench", "contact"},     {"quick", quick},
            {"cores", usableCores()}, {"simd_targets", engine::simdTargets()},
            {"cells", all},           {"limits", printVerdicts(judgeContact(cells))}};
}

} // namespace filasofia::app
