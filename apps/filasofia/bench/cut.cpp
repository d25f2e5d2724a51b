#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/cut_run.h"
#include "filasofia/core/text.h"
#include "filasofia/engine/native_engine.h"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <numeric>

namespace filasofia::app {
namespace {

using nlohmann::json;

double highest(const std::vector<double>& values) { return values.empty() ? 0.0 : std::ranges::max(values); }
double mean(const std::vector<double>& values)
{
    return values.empty() ? 0.0
                          : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}
double median(const std::vector<double>& values) { return runtime::spreadOf(values).median; }

json distribution(const std::vector<double>& values)
{
    json all = spreadToJson(runtime::spreadOf(values));
    all["mean"] = mean(values);
    all["max"] = highest(values);
    return all;
}

json toJson(const CutTimes& cut)
{
    return {{"scene", cut.scene.name},
            {"tetrahedra", cut.tetrahedra},
            {"speed_m_s", cut.scene.speed},
            {"repetitions", cut.scene.repetitions},
            {"steps_counted", cut.steps.size()},
            {"topology_s", distribution(cut.topology)},
            {"contacts_s", distribution(cut.contacts)},
            {"advance_s", distribution(cut.advance)},
            {"step_s", distribution(cut.steps)},
            {"iterations_before", distribution(cut.before)},
            {"iterations_during", distribution(cut.during)},
            {"iterations_after", distribution(cut.after)},
            {"opened_m2", cut.area},
            {"pieces", cut.pieces},
            {"steps_that_opened", cut.edits},
            {"flags", cut.flags},
            {"cores_taken_by_others", cut.others}};
}

void printHead()
{
    std::printf("instruction set %s, one thread, steps of %g ms; processor time in ms of the steps in which the "
                "blade moves; "
                "iterations: median (highest)\n\n",
                engine::simdTargets().front().c_str(), 1e3 * kContactStep);
    std::printf("%-28s %6s %8s %8s %8s %8s %8s %8s %8s %8s %11s %11s %11s %7s %6s\n", "scene", "tets", "topology",
                "median", "p99", "max", "contacts", "p99", "advance", "p99", "iter before", "during", "after", "opened",
                "others");
}

std::string iterations(const std::vector<double>& values) { return text(median(values), " (", highest(values), ")"); }

void print(const CutTimes& cut)
{
    const auto ms = [](double seconds) { return 1e3 * seconds; };
    const auto p99 = [](const std::vector<double>& values) { return 1e3 * runtime::spreadOf(values).p99; };
    std::printf("%-28s %6d %8.4f %8.4f %8.4f %8.4f %8.3f %8.3f %8.3f %8.3f %11s %11s %11s %4.1f cm2 %6.2f%s\n",
                cut.scene.name.c_str(), cut.tetrahedra, ms(mean(cut.topology)), ms(median(cut.topology)),
                p99(cut.topology), ms(highest(cut.topology)), ms(median(cut.contacts)), p99(cut.contacts),
                ms(median(cut.advance)), p99(cut.advance), iterations(cut.before).c_str(),
                iterations(cut.during).c_str(), iterations(cut.after).c_str(), 1e4 * cut.area, median(cut.others),
                cut.flags == 0 ? "" : "  flags");
    std::fflush(stdout);
}

using Figure = std::function<double(const CutTimes&)>;
using Which = std::function<bool(const CutTimes&)>;

Verdict judge(const std::vector<CutTimes>& cuts, const Which& which, const Figure& figure, double bound,
              const std::string& limit, const std::string& unit)
{
    const CutTimes* worst = nullptr;
    for (const CutTimes& cut : cuts)
        if (which(cut) && (!worst || figure(cut) > figure(*worst))) worst = &cut;
    if (!worst) return {limit, {}, "not measured"};
    return {limit, figure(*worst) <= bound,
            text("highest ", rounded(figure(*worst), 1e4), unit, " (", worst->scene.name, ")")};
}

std::vector<Verdict> judgeCuts(const std::vector<CutTimes>& cuts)
{
    constexpr int kAsked = 19000; // "20,000"
    const auto alone = [](const CutTimes& cut) { return !cut.scene.touched && cut.tetrahedra >= kAsked; };
    const auto touched = [](const CutTimes& cut) { return cut.scene.touched && cut.tetrahedra >= kAsked; };
    const auto any = [](const CutTimes&) { return true; };
    const auto meanMs = [](const CutTimes& cut) { return 1e3 * mean(cut.topology); };
    const auto p99Ms = [](const CutTimes& cut) { return 1e3 * runtime::spreadOf(cut.topology).p99; };
    const auto ratio = [](const CutTimes& cut) { return mean(cut.after) / std::max(1.0, mean(cut.before)); };
    const auto flags = [](const CutTimes& cut) { return static_cast<double>(cut.flags); };
    return {judge(cuts, alone, meanMs, 0.03, "20000 tetrahedra: mean of the topology work at most 0.03 ms", " ms"),
            judge(cuts, alone, p99Ms, 0.25, "20000 tetrahedra: p99 of the topology work at most 0.25 ms", " ms"),
            judge(cuts, touched, p99Ms, 1.0, "with attachments and contact: p99 at most 1 ms", " ms"),
            judge(cuts, any, ratio, 2.0, "mean iterations after a cut at most twice those before", ""),
            judge(cuts, any, flags, 0.0, "no step raises a flag", "")};
}

} // namespace

json benchCut(bool quick)
{
    printHead();
    const int cells = quick ? 10 : 16, repetitions = quick ? 1 : 3;
    std::vector<CutTimes> cuts;
    json all = json::array();
    for (const bool touched : {false, true})
        for (const bool through : {false, true}) {
            cuts.push_back(
                timeCut({.name = text(touched ? "held and touched" : "alone", through ? ", through" : ", half"),
                         .cells = cells,
                         .touched = touched,
                         .share = through ? 1.1 : 0.5,
                         .repetitions = repetitions}));
            print(cuts.back());
            all.push_back(toJson(cuts.back()));
        }
    return {{"bench", "cut"},       {"quick", quick}, {"simd_targets", engine::simdTargets()},
            {"dt_s", kContactStep}, {"cells", all},   {"limits", printVerdicts(judgeCuts(cuts))}};
}

} // namespace filasofia::app
