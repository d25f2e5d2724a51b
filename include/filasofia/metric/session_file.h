#pragma once

#include "filasofia/metric/session.h"

#include <filesystem>
#include <iosfwd>
#include <span>

/// A session as JSON Lines: a header, then a line per moment with the samples of all tracks and a line per event, and
/// an end. docs/guide/report.md describes the format. What was written stays readable whatever happens to the writer.
namespace filasofia::metric {

inline constexpr int kSessionVersion = 1;

// The lines, each with its line break, for a program that writes a session while it runs. Numbers read back to the same
// bits.
std::string headLine(const Session& session);
/// `samples`: one per track, all at the same time.
void appendSampleLine(std::string& out, const Session& session, std::span<const Sample> samples);
std::string eventLine(const Event& event);
/// What is later than `time` [s] has been taken back.
std::string backLine(double time);
std::string endLine(std::uint64_t lost);

/// Writes a whole session. Throws an Error if its tracks were not sampled together, or if the file cannot be written.
void writeSession(const std::filesystem::path& file, const Session& session);
/// Throws an Error naming file and line if it is not a session, of another version, or damaged. A session that was
/// interrupted is read up to its last line (Session::complete). The file must be a regular one.
Session readSession(const std::filesystem::path& file);
/// Reads a session from a stream; errors call it by `name`.
Session readSession(std::istream& stream, const std::string& name);

} // namespace filasofia::metric
