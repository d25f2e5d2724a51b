#include "filasofia/runtime/simulation.h"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>

namespace filasofia::runtime {
namespace {

std::string line(const char* format, auto... values)
{
    char buffer[200];
    std::snprintf(buffer, sizeof buffer, format, values...);
    return std::string(buffer) + "\n";
}

constexpr int kRefused = 2; ///< exit code: the user's words or files were wrong

} // namespace

std::string summary(const RunReport& report)
{
    const Spread cost = report.timing.cost(), rate = report.timing.rate();
    std::string out = line("%llu steps, %.3f s simulated in %.3f s (%.2f x real time); ended: %s",
                           static_cast<unsigned long long>(report.timing.stepCount), report.timing.simulatedSeconds,
                           report.timing.wallSeconds, report.timing.realTimeFactor(), report.finished.c_str());
    out += line("one step takes [ms]    median %8.3f   p1 %8.3f   p99 %8.3f", cost.median * 1e3, cost.p1 * 1e3,
                cost.p99 * 1e3);
    out += line("physics rate [1/s]     median %8.1f   p1 %8.1f   p99 %8.1f", rate.median, rate.p1, rate.p99);
    out += text("late steps ", report.timing.late, ", clamped by slack ", report.timing.clamped, ", put back ",
                report.undone, ", of these made again damped ", report.damped, ", solver at its cap ",
                report.notConverged, ", at the deadline ", report.outOfTime, "\n");
    if (report.visual.framesDrawn > 0 && report.timing.wallSeconds > 0.0)
        out += line("pictures drawn %ld", report.visual.framesDrawn);
    for (const std::string& picture : report.pictures) out += "wrote " + picture + "\n";
    out += line("state hash %016llx", static_cast<unsigned long long>(report.hash));
    return out;
}

int Simulation::run(int argc, const char* const* argv)
{
    RunDef def;
    CLI::App app("A Filasofia simulation");
    app.add_flag("--headless", def.headless, "a plain loop without window or clock, the same every time");
    app.add_option("--steps", def.steps, "end after as many steps (headless: 1000 unless given)");
    app.add_option("--seconds", def.seconds, "end after as many seconds of wall time");
    const CLI::Validator named([](const std::string& word) { return word.empty() ? "a file name is empty" : ""; }, "");
    app.add_option("--picture", def.picture, "write the last state to this PNG file")->check(named);
    app.add_option("--picture-every", def.pictureEvery, "with --headless: numbered pictures, seconds apart");
    app.add_option("--log", def.log, "write a line per step to this CSV file")->check(named);
    app.add_option("--record", def.record, "write the run to this .rec file, for 'filasofia replay'")->check(named);
    try {
        app.parse(argc, argv);
        if (def.headless && def.steps == 0) def.steps = 1000; // nobody could close it
        std::cout << summary(run(def));
        if (!std::cout.flush()) fail("cannot write to standard output");
        return 0;
    } catch (const CLI::CallForHelp&) {
        std::cout << app.help();
        return 0;
    } catch (const CLI::ParseError& problem) {
        return report(Error(problem.what()));
    } catch (const Error& problem) {
        return report(problem);
    }
}

int report(const Error& error)
{
    std::cerr << error.what() << '\n';
    return kRefused;
}

} // namespace filasofia::runtime
