#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/rod_scenes.h"
#include "filasofia/core/text.h"
#include "filasofia/runtime/clock.h"

#include <cmath>
#include <cstdio>

namespace filasofia::app {
namespace {

using nlohmann::json;
using runtime::Spread;

struct RodTimes {
    std::string label = {};
    int nodes = 0;
    int tetrahedra = 0;
    Spread step = {};      ///< [s]
    double contacts = 0.0; ///< mean number of contacts that push
    double self = 0.0;     ///< the same of the rod with itself
    double iterations = 0.0;
    std::uint32_t flags = 0;
};

/// `share` of the time that is to be counted.
RodTimes timeRod(const RodScene& rod, double share)
{
    ContactRun run(rod.scene, 1);
    for (int i = 0; i < std::lround(rod.scene.settle / kContactStep); ++i) run.step();
    const auto now = runtime::steadyClock().now;
    const auto steps = std::lround(share * rod.counted / kContactStep);
    RodTimes times{.label = rod.scene.name, .nodes = rod.nodes, .tetrahedra = rod.scene.elements()};
    std::vector<double> costs;
    for (int i = 0; i < steps; ++i) {
        const runtime::Nanoseconds begun = now();
        const physics::StepReport report = run.step();
        costs.push_back(1e-9 * static_cast<double>(now() - begun));
        times.flags |= report.flags;
        times.iterations += static_cast<double>(iterationsOf(report)) / static_cast<double>(steps);
        for (const frame::Contact& contact : run.capture().contacts) {
            if (!(contact.normalForce > 0.0)) continue;
            times.contacts += 1.0 / static_cast<double>(steps);
            times.self += contact.first == contact.second ? 1.0 / static_cast<double>(steps) : 0.0;
        }
    }
    times.step = runtime::spreadOf(costs);
    return times;
}

void print(const RodTimes& times)
{
    std::printf("%5d  %-28s %6d %8.3f %8.3f %9.0f %6.0f %6.1f\n", times.nodes, times.label.c_str(), times.tetrahedra,
                1e3 * times.step.median, 1e3 * times.step.p99, times.contacts, times.self, times.iterations);
    std::fflush(stdout);
}

json toJson(const RodTimes& times)
{
    return {{"rod", times.label},
            {"nodes", times.nodes},
            {"tetrahedra", times.tetrahedra},
            {"step_s", spreadToJson(times.step)},
            {"contacts_mean", times.contacts},
            {"self_contacts_mean", times.self},
            {"iterations_mean", times.iterations},
            {"flags", times.flags}};
}

} // namespace

json benchRod(bool quick, const std::string& only)
{
    std::vector<RodScene> scenes{hangingRod(200),  rodOnFloor(200),  coiledRod(200), knottedRod(200),
                                 hangingRod(1000), rodOnFloor(1000), stitch()};
    for (const int blocks : {1, 4, 8, 16}) scenes.push_back(drawnThrough(blocks));
    std::printf("one thread, steps of 1 ms\n\n%5s  %-28s %6s %8s %8s %9s %6s %6s\n", "nodes", "it", "tets", "step ms",
                "p99", "contacts", "self", "iter");
    json cells = json::array();
    std::vector<RodTimes> all;
    for (const RodScene& scene : scenes) {
        if (scene.scene.label().find(only) == std::string::npos) continue;
        const RodTimes& times = all.emplace_back(timeRod(scene, quick ? 0.3 : 1.0));
        print(times);
        cells.push_back(toJson(times));
    }
    const auto of = [&](int nodes, const char* label, double Spread::*figure) {
        std::vector<Measured> found;
        for (const RodTimes& each : all)
            if (each.nodes == nodes && each.label == label) found.push_back({each.step.*figure, each.label});
        return found;
    };
    constexpr auto kMedian = &Spread::median, kP99 = &Spread::p99;
    constexpr double kMs = 1e-3;
    const auto knot = of(200, "is knotted and drawn tight", kMedian), hanging = of(1000, "hangs by one end", kMedian);
    const auto stitches = [&](double Spread::*figure) { return of(150, "stitches a wound", figure); };
    const std::vector<Verdict> verdicts{
        atMost(knot, 0.3 * kMs, "200 nodes in a tight knot take at most 0.3 ms", kMs),
        atMost(hanging, 1.5 * kMs, "1,000 nodes take at most 1.5 ms", kMs),
        atMost(stitches(kMedian), kMs, "a stitch takes at most 1 ms in the median", kMs),
        atMost(stitches(kP99), 2.0 * kMs, "a stitch takes at most 2 ms in the 99th percentile", kMs)};
    return {{"bench", "rod"}, {"quick", quick}, {"cells", cells}, {"limits", printVerdicts(verdicts)}};
}

} // namespace filasofia::app
