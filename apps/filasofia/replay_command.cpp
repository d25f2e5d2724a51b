#include "apps/filasofia/build_info.h"
#include "apps/filasofia/command_line.h"
#include "apps/filasofia/commands.h"

#include "filasofia/core/error.h"
#include "filasofia/core/hash.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/runtime/replay.h"

#include <cstdio>
#include <iostream>

namespace filasofia::app {
namespace {

struct ReplayCommandOptions {
    int threads = 0;
    runtime::ReplayDef replay;
};

/// The program that made a recording, or this program: everything that decides the bits of a result.
struct Maker {
    std::string version, revision, simd;
};

std::string described(const Maker& maker)
{
    const auto shown = [](const std::string& word) { return word.empty() ? "unknown" : shortened(oneLine(word)); };
    return text("Filasofia ", shown(maker.version), ", revision ", shown(maker.revision), ", vector instructions ",
                shown(maker.simd));
}

/// The difference between the recording program and this one, as a sentence; empty if there is none.
std::string likelyReason(const Maker& recorder, const Maker& self)
{
    const bool otherBuild = recorder.version != self.version || recorder.revision != self.revision;
    const bool otherSimd = !recorder.simd.empty() && recorder.simd != self.simd;
    if (!otherBuild && !otherSimd) return {};
    return text("the likely reason: ", otherBuild ? "another build" : "", otherBuild && otherSimd ? " and " : "",
                otherSimd ? "other vector instructions" : "", "; this is ", described(self), "\n");
}

/// The names that the recording's header gives, if any.
std::string namesOf(const record::RecordingHeader& header)
{
    std::string line;
    const auto add = [&](const char* what, const std::string& name) {
        if (!name.empty()) line += text(line.empty() ? "" : ", ", what, " '", shortened(oneLine(name)), "'");
    };
    add("session", header.session);
    add("trainee", header.trainee);
    if (header.seed != 0) line += text(line.empty() ? "" : ", ", "seed ", header.seed);
    return line.empty() ? line : line + '\n';
}

int replayFile(ReplayCommandOptions& options)
{
    options.replay.threads = givenThreads(options.threads);
    const runtime::ReplayReport report = runtime::replay(options.replay);
    const record::RecordingHeader& header = report.header;
    const Maker recorder = {header.filasofia, header.revision, header.simd};
    const Maker self = {kVersion, std::string(record::sourceRevision()), engine::simdTargets().front()};

    if (report.made == 0) throw Error(report.damage.empty() ? options.replay.file + ": holds no step" : report.damage);
    std::cout << "recorded by " << described(recorder) << '\n' << namesOf(header);
    std::printf("%llu %s, %.3f s simulated, replayed in %.3f s\n", static_cast<unsigned long long>(report.step),
                report.step == 1 ? "step" : "steps", report.time, report.wallSeconds);
    for (const std::string& note : report.notes) std::cout << "note: " << note << '\n';
    for (const std::string& picture : report.pictures) std::cout << "wrote " << picture << '\n';
    if (const auto& difference = report.difference) {
        std::cout << "step " << difference->step << " differs: recorded " << hexadecimal(difference->recorded)
                  << ", replayed " << hexadecimal(difference->replayed) << '\n'
                  << likelyReason(recorder, self);
        return kFailed;
    }
    if (report.unhashed > 0)
        fail(options.replay.file, ": step ", report.unhashed, " was recorded without a hash to compare");
    if (options.replay.check) std::cout << "every step has the recorded hash\n";
    std::cout << "state hash " << hexadecimal(report.hash) << '\n';
    if (!report.damage.empty()) throw Error(report.damage);
    return 0;
}

} // namespace

Command replayCommand()
{
    // Static: there is one command line, and its targets must outlive this function.
    static ReplayCommandOptions options;
    return {.name = "replay",
            .meaning = "Replay a recorded run as fast as possible",
            .options = {{"RECORDING", &options.replay.file, "A file written by run --record FILE", "FILE", {}, true},
                        {"--check", &options.replay.check,
                         "Compare the state after every step; stop with exit code 1 at the first difference"},
                        {"--picture", &options.replay.picture, "Write a picture of the last state to this PNG file",
                         "FILE"},
                        {"--video", &options.replay.video, "Write the run to this file: .avi, or .mp4 (needs ffmpeg)",
                         "FILE"},
                        {.name = "--fps",
                         .target = &options.replay.fps,
                         .meaning = "Pictures of the video per second of simulated time",
                         .bound = boundOf(&runtime::ReplayDef::fps)},
                        {.name = "--threads",
                         .target = &options.threads,
                         .meaning = "Threads within one step; 0: all cores except one, at most 8",
                         .bound = kThreads}},
            .run = [] { return replayFile(options); }};
}

} // namespace filasofia::app
