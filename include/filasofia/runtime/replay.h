#pragma once

#include "filasofia/record/recording.h"
#include "filasofia/record/replay.h"

#include <string>

namespace filasofia::runtime {

/// How a recorded run is made again.
struct ReplayDef {
    std::string file = {};           ///< the recording
    bool check = false;              ///< compare the hash of every step; end at the first that differs
    std::optional<int> threads = {}; ///< [-], in [1, 256], as PhysicsDef::threads
    std::string picture = {};        ///< a PNG file for the last state; empty: none
    std::string video = {};          ///< an MP4 file, made by the program ffmpeg; empty: none
    double fps = 30.0;               ///< [1/s], in [1, 240], pictures of the video in simulated time
};
constexpr auto fields(const ReplayDef*)
{
    using T = ReplayDef;
    return describe(
        "ReplayDef", field("file", &T::file, "the recording"), field("check", &T::check, "compare every step"),
        field("threads", &T::threads, "-", closed(1, 256), "at work within one step"),
        field("picture", &T::picture, "a PNG file for the last state"), field("video", &T::video, "an MP4 file"),
        field("fps", &T::fps, "1/s", closed(1, 240), "pictures of the video"));
}

/// How that went.
struct ReplayReport {
    record::RecordingHeader header = {};
    std::uint64_t made = 0;                            ///< [-], steps, paused ones too
    std::uint64_t step = 0;                            ///< [-], number of the last
    double time = 0.0;                                 ///< [s], simulated
    double wallSeconds = 0.0;                          ///< [s]
    std::uint64_t hash = 0;                            ///< of the last state
    std::optional<record::Difference> difference = {}; ///< where it was checked
    std::uint64_t unhashed = 0;                        ///< the first step without a hash to compare; 0: none
    std::string damage = {};                           ///< what ended the file before the session's end
    std::vector<std::string> pictures = {};            ///< files written, the video too
    std::vector<std::string> notes = {};               ///< what the pictures lack of the recorded scene
};

/// Makes a recorded run again, up to its end or to what is damaged of it, as fast as it goes, and draws it as it was
/// drawn. Throws an Error where the file cannot be read, a step cannot be made again, or a picture not be drawn: also
/// where a texture that the scene names is missing or has changed.
ReplayReport replay(const ReplayDef& def);

} // namespace filasofia::runtime
