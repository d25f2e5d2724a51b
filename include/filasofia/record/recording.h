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
    std::uint64_t seed = 0;              ///< of what was drawn by chance, as the program that recorded means it
    std::string session = {};            ///< what it was called: any text
    std::string trainee = {};            ///< who was at it: any text
    std::string date = {};               ///< as dateNow() told when it began: any text
};

/// What was drawn and how, in the words of the room that draws: a recording keeps it, and does not read it.
struct SceneRecord {
    std::string words = "{}";                                                 ///< a JSON object
    std::vector<std::shared_ptr<const geometry::TriangleMesh>> surfaces = {}; ///< the words name them by their place
};

/// The git revision of this program's source; where it was configured without git, its version.
std::string_view sourceRevision();

/// Writes a run into a file as it goes: steps, what is drawn, and every mesh once, so that a replay needs nothing else.
/// docs/design/replay.md describes the bytes. What was flushed stays readable whatever happens to the program
/// afterwards.
class RecordingWriter {
public:
    /// Throws an Error naming the file when it cannot be written, or is being written already by this program or
    /// another, under whatever name; so do the others, when the disk is full.
    RecordingWriter(const std::filesystem::path& file, const RecordingHeader& header);
    ~RecordingWriter();
    /// Steps in their order. Warns once, in the log, of a step that no replay can make again.
    void write(const physics::StepRecord& step);
    /// What changes in the scene after the last step that was written.
    void write(const SceneRecord& scene);
    /// Hands all of it to the system. Costs up to 300 bytes: ten times a second is often enough, once a step too often.
    void flush();
    /// The end, which the file tells; nothing may be written after it. The destructor does it too, and can only log
    /// what goes wrong.
    void close();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Reads a recording step by step. Throws an Error naming the file, and the byte or record, where it is no recording,
/// of another version, damaged or cut off; all steps before that place are read first. It may come from anybody: what
/// it makes us allocate is bounded by its own length. It must be a regular file: a pipe or a device might never end.
class RecordingReader {
public:
    explicit RecordingReader(const std::filesystem::path& file);
    ~RecordingReader();
    [[nodiscard]] const RecordingHeader& header() const;
    /// The next step, or nothing at the end. It has what a replay needs: the report's step, dt, flags and the
    /// iterations of its solves, the hash, the commands (of a tune() only that there was one). Where it has thrown, it
    /// throws again.
    std::optional<physics::StepRecord> next();
    /// What changed in the scene before the step that next() gave last (after the end: after the last step), and was
    /// not taken yet.
    std::vector<SceneRecord> takeScene();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// A whole recording in memory.
struct Recording {
    RecordingHeader header = {};
    std::vector<physics::StepRecord> steps = {};
    std::string damage = {}; ///< what ended it before its end, as the Error says it; empty: it is whole
};
/// Throws where anything is damaged or missing.
Recording readRecording(const std::filesystem::path& file);
/// Reads all that can be: of a session whose program was killed, or a file that was damaged later. Throws where not
/// even the header can be read.
Recording readUpToDamage(const std::filesystem::path& file);

} // namespace filasofia::record
