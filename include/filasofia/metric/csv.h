#pragma once

#include "filasofia/metric/session.h"

#include <span>

/// Tables for spreadsheets.
namespace filasofia::metric {

/// A text as a cell: in quotes, its quotes doubled, its line breaks spaces; what a spreadsheet would take for a formula
/// (it begins with = + - @ or a tab) gets an apostrophe before it.
std::string csvCell(std::string_view text);

// A session: a line per moment, with what all tracks did, or with an event.
std::string csvHead(const Session& session);
void appendCsvLine(std::string& out, const Session& session, std::span<const Sample> samples);
std::string csvLine(const Session& session, const Event& event);

} // namespace filasofia::metric
