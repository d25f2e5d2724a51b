#pragma once

#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"

#include <string>

namespace filasofia::runtime {

/// How a recorded run is replayed.
struct ReplayDef {
    std::string file = {};           ///< the recording
    bool check = false;              ///< compare the hash of every step; end at the first that differs
    std::optional<int> threads = {}; ///< [-], in [1, 256], as PhysicsDef::threads
    std::string picture = {};        ///< a PNG file for the last state; empty: none
    std::string video = {};          ///< an .mp4 (encoded by the program ffmpeg) or .avi file; empty: none
    double fps = 30.0;               ///< [1/s], in [1, 240], pictures per second of simulated time in the video
};
constexpr auto fields(const ReplayDef*)
{
    using T = ReplayDef;
    return describe("ReplayDef", field("file", &T::file, "the recording"),
                    field("check", &T::check, "compare the hash of every step"),
                    field("threads", &T::threads, "-", closed(1, 256), "threads at work within one step"),
                    field("picture", &T::picture, "a PNG file for the last state"),
                    field("video", &T::video, "an MP4 or AVI file"),
                    field("fps", &T::fps, "1/s", closed(1, 240), "pictures per second of the video"));
}

/// How a replay went.
struct ReplayReport {
    record::RecordingHeader header = {};
    std::uint64_t made = 0;                            ///< [-], number of replayed steps, paused ones included
    std::uint64_t step = 0;                            ///< [-], number of the last step
    double time = 0.0;                                 ///< [s], simulated
    double wallSeconds = 0.0;                          ///< [s]
    std::uint64_t hash = 0;                            ///< hash of the last state
    std::optional<record::Difference> difference = {}; ///< the first difference, if hashes were compared
    std::uint64_t unhashed = 0;                        ///< the first step without a hash to compare; 0: none
    std::string damage = {};                ///< what ended the file before the session's end; empty: nothing did
    std::vector<std::string> pictures = {}; ///< files written, including the video
    std::vector<std::string> notes = {};    ///< what the pictures lack of the recorded scene
};

/// Replays a recorded run up to its end, or up to where the file is damaged, as fast as possible, and draws it as it
/// was drawn. Throws an Error if the file cannot be read, a step cannot be replayed, or a picture cannot be drawn; also
/// if a texture that the scene names is missing or has changed.
ReplayReport replay(const ReplayDef& def);

} // namespace filasofia::runtime
