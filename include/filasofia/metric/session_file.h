#pragma once

#include "filasofia/metric/session.h"

#include <filesystem>
#include <iosfwd>
#include <span>

/// A session as JSON Lines: a head, then a line per moment with what all tracks did, a line per event in between, and
/// an end. docs/guide/report.md describes it. What was written stays readable whatever happens to the writer.
namespace filasofia::metric {

inline constexpr int kSessionVersion = 1;

// The lines, each with its line break; for whoever writes a session as it goes. Numbers read back to the same bits.
std::string headLine(const Session& session);
/// `samples`: one per track, of the same time.
void appendSampleLine(std::string& out, const Session& session, std::span<const Sample> samples);
std::string eventLine(const Event& event);
std::string endLine(std::uint64_t lost);

/// The whole session; lines of samples need tracks that are sampled together. Throws Error where they are not, or where
/// the file cannot be written.
void writeSession(const std::filesystem::path& file, const Session& session);
/// Throws Error naming file and line where it is no session, of another version, or damaged. A session that broke off
/// is read up to there (Session::complete). It must be a regular file.
Session readSession(const std::filesystem::path& file);
/// The same of a stream; errors call it by `name`.
Session readSession(std::istream& stream, const std::string& name);

} // namespace filasofia::metric
