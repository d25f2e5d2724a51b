#include "apps/filasofia/bench/bench.h"
#include "apps/filasofia/bench/haptics_run.h"
#include "filasofia/core/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace filasofia::app {
namespace {

using nlohmann::json;

constexpr double kJitterLimit = 0.2e-3; ///< [s]
constexpr double kMargin = 5e-3;        ///< [s] a few ticks, for a machine that is not quiet

json toJson(const ServoTimes& run)
{
    const device::JitterHistogram& jitter = run.servo.jitter;
    // JSON has no infinity: empty if the percentile lies beyond the histogram.
    const auto percentile = [&](double share) {
        const double value = jitter.percentile(share);
        return std::isfinite(value) ? json(value) : json();
    };
    json all = {{"name", run.scene.name},
                {"physics_hz", run.scene.physicsRate},
                {"seconds", run.scene.seconds},
                {"stall_s", run.scene.stall},
                {"ticks", run.servo.ticks},
                {"rate_hz", run.servo.rate},
                {"jitter_s",
                 {{"median", percentile(0.5)},
                  {"p99", percentile(0.99)},
                  {"p999", percentile(0.999)},
                  {"max", run.servo.latest},
                  {"bin_s", device::JitterHistogram::kWidth},
                  {"counts", jitter.counts}}},
                {"energy_J", run.servo.energy},
                {"most_force_N", run.maxForce},
                {"cores_taken_by_others", run.others}};
    if (run.scene.stall > 0.0) {
        all["zero_after_s"] = run.zeroAfter;
        all["watchdog_s"] = run.zeroWithin;
        all["pushes_in_stall"] = run.pushesInStall;
        all["largest_change_after_N"] = run.ramp;
    }
    return all;
}

json toJson(const WallEnergy& wall)
{
    return {{"physics_hz", wall.physicsRate},  {"stiffness_N_m", wall.stiffness},  {"jitter_s", wall.jitter},
            {"most_energy_J", wall.netEnergy}, {"given_by_hand_J", wall.handWork}, {"most_force_N", wall.force}};
}

void print(const ServoTimes& run)
{
    const device::JitterHistogram& jitter = run.servo.jitter;
    std::printf("%-18s %8.0f %8.1f %8.2f %8.2f %8.2f %8.2f %9.5f %7.2f", run.scene.name.c_str(), run.scene.physicsRate,
                run.servo.rate, 1e3 * jitter.percentile(0.5), 1e3 * jitter.percentile(0.99),
                1e3 * jitter.percentile(0.999), 1e3 * run.servo.latest, run.servo.energy, run.others);
    if (run.scene.stall > 0.0)
        std::printf("   zero force %.1f ms after physics stopped, limit %.0f ms", 1e3 * run.zeroAfter,
                    1e3 * run.zeroWithin);
    std::printf("\n");
    std::fflush(stdout);
}

std::vector<Verdict> judge(const std::vector<ServoTimes>& runs, const std::vector<WallEnergy>& walls)
{
    std::vector<Verdict> all;
    for (const ServoTimes& run : runs) {
        if (run.scene.stall > 0.0) {
            const bool met = run.zeroAfter <= run.zeroWithin + kMargin && run.pushesInStall == 0;
            all.push_back(
                {text(run.scene.name, ": the force is zero within the watchdog's ", 1e3 * run.zeroWithin, " ms"), met,
                 text("after ", rounded(1e3 * run.zeroAfter, 10), " ms; ", run.pushesInStall,
                      " ticks with a force after that, until physics resumed")});
            continue;
        }
        const double p999 = run.servo.jitter.percentile(0.999);
        all.push_back(
            {text(run.scene.name, ": p99.9 of the jitter at most 0.2 ms"), p999 <= kJitterLimit,
             text(rounded(1e3 * p999, 100), " ms; ", rounded(run.others, 10), " cores used by other programs")});
        all.push_back({text(run.scene.name, ": net energy given to the hand at most 0"), run.servo.energy <= 0.0,
                       text(rounded(run.servo.energy, 1e6), " J")});
    }
    const auto worst = std::ranges::max_element(walls, {}, &WallEnergy::netEnergy);
    all.push_back({"every wall up to 10 kN/m: net energy given to the hand at most 0, at any moment",
                   worst->netEnergy <= 0.0, text("highest ", worst->netEnergy, " J, at ", worst->stiffness, " N/m")});
    return all;
}

} // namespace

json benchHaptics(double seconds, bool quick)
{
    std::printf("a scripted hand pokes a wall; jitter: how late the servo's thread wakes, in ms; energy given to the "
                "hand in J\n\n%-18s %8s %8s %8s %8s %8s %8s %9s %7s\n",
                "run", "physics", "servo", "median", "p99", "p99.9", "max", "energy", "others");
    const ServoTimes alone = timeClock(seconds);
    print(alone);
    std::vector<ServoTimes> runs;
    for (const ServoScene& scene : {ServoScene{.name = "physics at 1 kHz", .physicsRate = 1000.0, .seconds = seconds},
                                    ServoScene{.name = "physics at 20 Hz", .physicsRate = 20.0, .seconds = seconds},
                                    ServoScene{.name = "stalled for 1 s", .seconds = 3.0, .stall = 1.0}}) {
        runs.push_back(timeServo(scene));
        print(runs.back());
    }

    std::printf("\na rigid wall, undamped, 20 s on a simulated clock: the highest net energy [mJ] given to the hand at "
                "any moment,\nand in brackets the highest energy that the hand had put in\n\n%9s %20s %20s %20s %20s\n",
                "[N/m]", "1 kHz", "1 kHz, late ticks", "20 Hz", "20 Hz, late ticks");
    std::vector<WallEnergy> walls;
    std::vector<double> stiffnesses = {100, 200, 500, 1000, 2000, 5000, 10000};
    if (quick) stiffnesses = {500, 10000};
    for (const double stiffness : stiffnesses) {
        std::printf("%9.0f", stiffness);
        for (const double rate : {1000.0, 20.0})
            for (const double jitter : {0.0, 0.2e-3}) {
                walls.push_back(pokeWall(rate, stiffness, jitter));
                std::printf(" %11.4f (%6.1f)", 1e3 * walls.back().netEnergy, 1e3 * walls.back().handWork);
            }
        std::printf("\n");
    }
    json allRuns = json::array(), allWalls = json::array();
    for (const ServoTimes& run : runs) allRuns.push_back(toJson(run));
    for (const WallEnergy& wall : walls) allWalls.push_back(toJson(wall));
    return {{"bench", "haptics"}, {"quick", quick},    {"clock_alone", toJson(alone)},
            {"runs", allRuns},    {"walls", allWalls}, {"limits", printVerdicts(judge(runs, walls))}};
}

} // namespace filasofia::app
