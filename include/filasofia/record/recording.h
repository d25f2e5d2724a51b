#pragma once

#include "filasofia/physics/step_record.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace filasofia::record {

/// What a recording says of itself before its first step.
struct RecordingHeader {
    std::string filasofia = {};          ///< version that wrote it; the writer puts its own
    std::string revision = {};           ///< of its source (sourceRevision()); the writer puts its own; empty: not told
    std::string simd = {};               ///< vector instructions that the engine used; empty: not told
    double period = 1e-3;                ///< [s], what the engine's solvers were prepared for
    physics::ContactMethod contact = {}; ///< how bodies that touched pushed each other
};

/// The git revision of this program's source; where it was configured without git, its version.
std::string_view sourceRevision();

/// Writes a run into a file as it goes: a line per step, and every mesh once, so that a replay needs nothing else.
/// docs/runtime.md describes the lines. What was flushed stays readable whatever happens to the program afterwards.
class RecordingWriter {
public:
    /// Throws an Error naming the file when it cannot be written, or is being written already by this program or
    /// another, under whatever name; so do the others, when the disk is full.
    RecordingWriter(const std::filesystem::path& file, const RecordingHeader& header);
    ~RecordingWriter();
    /// Steps in their order. Warns once, in the log, of a step that no replay can make again.
    void write(const physics::StepRecord& step);
    void flush();
    /// The end; nothing may be written after it. The destructor does it too, and can only log what goes wrong.
    void close();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Reads a recording step by step. Throws an Error naming file and line where it is no recording, of another version,
/// damaged or cut off. It must be a regular file: a pipe or a device might never end.
class RecordingReader {
public:
    explicit RecordingReader(const std::filesystem::path& file);
    ~RecordingReader();
    [[nodiscard]] const RecordingHeader& header() const;
    /// The next step, or nothing at the end. It has what a replay needs: the report's step, dt, flags and the
    /// iterations of its solves, the hash, the commands (of a tune() only that there was one).
    std::optional<physics::StepRecord> next();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// A whole recording in memory.
struct Recording {
    RecordingHeader header = {};
    std::vector<physics::StepRecord> steps = {};
};
Recording readRecording(const std::filesystem::path& file);

} // namespace filasofia::record
