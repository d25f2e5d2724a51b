#include "apps/filasofia/build_info.h"
#include "apps/filasofia/command_line.h"
#include "apps/filasofia/commands.h"

#include "filasofia/core/error.h"
#include "filasofia/core/hash.h"
#include "filasofia/engine/native_engine.h"
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

/// Whose bits were compared, where they are not our own.
std::string writtenBy(const record::RecordingHeader& header)
{
    if (header.filasofia == kVersion) return {};
    return text(" (recorded with Filasofia ", oneLine(header.filasofia), ", this is ", kVersion, ")");
}

int replayFile(const Options& options)
{
    record::RecordingReader reader(options.file);
    const auto engine =
        engine::makeNativeEngine({.period = reader.header().period, .threads = givenThreads(options.threads)});
    record::Replayer replayer(*engine);

    const auto start = std::chrono::steady_clock::now();
    physics::StepReport last;
    bool any = false;
    while (const auto step = reader.next()) {
        any = true;
        last = replayer.step(*step);
        if (!options.check) continue;
        if (step->hash == 0) fail(options.file, ": step ", last.step, " was recorded without a hash to compare");
        if (const std::uint64_t hash = engine->hash(); hash != step->hash) {
            std::cout << "step " << last.step << " differs: recorded " << hexadecimal(step->hash) << ", replayed "
                      << hexadecimal(hash) << writtenBy(reader.header()) << '\n';
            return kFailed;
        }
    }
    if (!any) fail(options.file, ": holds no step");
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    std::printf("%llu steps, %.3f s simulated, made again in %.3f s\n", static_cast<unsigned long long>(last.step),
                last.time, wall.count());
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
                        {"--threads", &options.threads, "Threads within one step; 0: the cores but one, up to 8", "N"}},
            .run = [] { return replayFile(options); }};
}

} // namespace filasofia::app
