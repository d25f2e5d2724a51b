#pragma once

#include "filasofia/metric/session.h"

#include <span>

/// Tables for spreadsheets.
namespace filasofia::metric {

/// A text as a cell: in quotes, with its quotes doubled and its line breaks replaced by spaces. If a spreadsheet would
/// take it for a formula (it begins with = + - @ or a tab), an apostrophe is put before it.
std::string csvCell(std::string_view text);

// A session: a line per moment with the samples of all tracks, or a line with an event.
std::string csvHead(const Session& session);
void appendCsvLine(std::string& out, const Session& session, std::span<const Sample> samples);
std::string csvLine(const Session& session, const Event& event);

} // namespace filasofia::metric
