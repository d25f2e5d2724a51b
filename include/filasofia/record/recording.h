#pragma once

#include "filasofia/physics/step_record.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace filasofia::record {

/// The header of a recording.
struct RecordingHeader {
    std::string filasofia = {};    ///< version that wrote it; set by the writer
    std::string revision = {};     ///< revision of its source (sourceRevision()); set by the writer; empty if unknown
    std::string simd = {};         ///< vector instructions that the engine used; empty if unknown
    std::string engine = "native"; ///< the name of the engine; the file has it only if it is another one
    double period = 1e-3;          ///< [s], the period that the engine's solvers were prepared for
    physics::ContactMethod contact = {}; ///< the contact method
    std::uint64_t seed = 0;              ///< random seed, as defined by the program that recorded
    std::string session = {};            ///< name of the session: any text
    std::string trainee = {};            ///< name of the trainee: any text
    std::string date = {};               ///< start of the session, from dateNow(): any text
};

/// Told of a field that a recording of another revision does not have, as "CollisionDef.selfOnceCut".
using MissingField = std::function<void(const std::string&)>;

/// What was drawn and how, in the format of the room that draws: a recording stores it without reading it.
struct SceneRecord {
    std::string words = "{}";                                                 ///< a JSON object
    std::vector<std::shared_ptr<const geometry::TriangleMesh>> surfaces = {}; ///< `words` refers to them by index
    MissingField missing = {}; ///< set by the reader if another revision wrote it: its missing fields have defaults
};

/// The git revision of this program's source; its version if it was configured without git.
std::string_view sourceRevision();

/// Writes a run into a file during the run: steps, what is drawn, and every mesh once, so that a replay needs nothing
/// else. docs/design/replay.md describes the bytes. What was flushed stays readable whatever happens to the program
/// afterwards.
class RecordingWriter {
public:
    /// Throws an Error naming the file if it cannot be written, or if this or another program is already writing it
    /// under any name. The other functions do so too, if the disk is full.
    RecordingWriter(const std::filesystem::path& file, const RecordingHeader& header);
    ~RecordingWriter();
    /// Steps must be written in their order. Logs one warning about the first step that cannot be replayed.
    void write(const physics::StepRecord& step);
    /// Changes of the scene after the last step that was written.
    void write(const SceneRecord& scene);
    /// Passes all data to the system. Costs up to 300 bytes: ten times a second is usually enough, once per step is too
    /// often.
    void flush();
    /// Writes the end of the session; nothing may be written after it. The destructor calls it too, but can only log
    /// errors.
    void close();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Reads a recording step by step. Throws an Error naming the file, and the byte or record, if it is not a recording,
/// of another version, damaged or cut off; all steps before that place are read first. If another revision of this
/// version wrote it, fields that it does not have get their defaults, and the log tells each once. The file is not
/// trusted: the memory that it makes the reader allocate is bounded by its own length. It must be a regular file,
/// because a pipe or a device might never end.
class RecordingReader {
public:
    explicit RecordingReader(const std::filesystem::path& file);
    ~RecordingReader();
    [[nodiscard]] const RecordingHeader& header() const;
    /// The next step, or nullopt at the end. It contains what a replay needs: the report's step, dt, flags and the
    /// iterations of its solves, the hash, and the commands (for a tune() only that there was one). After it has
    /// thrown, it throws again.
    std::optional<physics::StepRecord> next();
    /// The changes of the scene before the step that next() returned last (after the end: after the last step) that
    /// were not taken yet.
    std::vector<SceneRecord> takeScene();

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// A whole recording in memory.
struct Recording {
    RecordingHeader header = {};
    std::vector<physics::StepRecord> steps = {};
    std::string damage =
        {}; ///< the Error that ended reading before the session's end; empty if the recording is complete
};
/// Throws an Error if anything is damaged or missing.
Recording readRecording(const std::filesystem::path& file);
/// Reads as much as possible, such as from a session whose program was killed, or from a file that was damaged later.
/// Throws an Error if not even the header can be read.
Recording readUpToDamage(const std::filesystem::path& file);

} // namespace filasofia::record
