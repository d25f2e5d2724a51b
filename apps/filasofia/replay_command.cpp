#include "apps/filasofia/build_info.h"
#include "apps/filasofia/command_line.h"
#include "apps/filasofia/commands.h"

#include "filasofia/core/error.h"
#include "filasofia/core/hash.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/engine/solver_costs.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"

#include <chrono>
#include <cstdio>
#include <iostream>

namespace filasofia::app {
namespace {

struct Options {
    std::string file;
    bool check = false;
    int threads = 0;
};

/// What made the bits: of a recording, or of this program.
struct Maker {
    std::string version, revision, simd;
};

std::string described(const Maker& maker)
{
    const auto shown = [](const std::string& word) { return word.empty() ? "unknown" : shortened(oneLine(word)); };
    return text("Filasofia ", shown(maker.version), ", revision ", shown(maker.revision), ", vector instructions ",
                shown(maker.simd));
}

/// What is different about this program, as a sentence; empty where nothing is.
std::string likelyReason(const Maker& recorder, const Maker& self)
{
    const bool otherBuild = recorder.version != self.version || recorder.revision != self.revision;
    const bool otherSimd = !recorder.simd.empty() && recorder.simd != self.simd;
    if (!otherBuild && !otherSimd) return {};
    return text("the likely reason: ", otherBuild ? "another build" : "", otherBuild && otherSimd ? " and " : "",
                otherSimd ? "other vector instructions" : "", "; this is ", described(self), "\n");
}

int replayFile(const Options& options)
{
    record::RecordingReader reader(options.file);
    const auto engine = engine::makeNativeEngine({.period = reader.header().period,
                                                  .threads = givenThreads(options.threads),
                                                  .contact = reader.header().contact});
    record::Replayer replayer(*engine);
    const record::RecordingHeader& header = reader.header();
    const Maker recorder = {header.filasofia, header.revision, header.simd};
    const Maker self = {kVersion, std::string(record::sourceRevision()), engine::simdTargets().front()};
    const std::string recordedBy = text("recorded by ", described(recorder), "\n");

    const auto start = std::chrono::steady_clock::now();
    physics::StepReport last;
    bool any = false;
    while (const auto step = reader.next()) {
        any = true;
        last = replayer.step(*step);
        if (!options.check) continue;
        if (step->hash == 0) fail(options.file, ": step ", last.step, " was recorded without a hash to compare");
        if (const std::uint64_t hash = engine->hash(); hash != step->hash) {
            std::cout << recordedBy << "step " << last.step << " differs: recorded " << hexadecimal(step->hash)
                      << ", replayed " << hexadecimal(hash) << '\n'
                      << likelyReason(recorder, self);
            return kFailed;
        }
    }
    if (!any) fail(options.file, ": holds no step");
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    std::cout << recordedBy;
    std::printf("%llu %s, %.3f s simulated, made again in %.3f s\n", static_cast<unsigned long long>(last.step),
                last.step == 1 ? "step" : "steps", last.time, wall.count());
    if (options.check) std::cout << "every step has the recorded hash\n";
    std::cout << "state hash " << hexadecimal(engine->hash()) << '\n';
    return 0;
}

} // namespace

Command replayCommand()
{
    static Options options; // there is one command line, and it outlives this function
    return {.name = "replay",
            .meaning = "Make a recorded run again, as fast as it goes",
            .options = {{"RECORDING", &options.file, "What run --record FILE wrote", "FILE", {}, true},
                        {"--check", &options.check,
                         "Compare the state after every step; exit with 1 at the first that differs"},
                        {.name = "--threads",
                         .target = &options.threads,
                         .meaning = "Threads within one step; 0: the cores but one, up to 8",
                         .bound = kThreads}},
            .run = [] { return replayFile(options); }};
}

} // namespace filasofia::app
