#pragma once

#include "filasofia/metric/catalog.h"

#include <filesystem>
#include <string>
#include <vector>

/// `filasofia report`: what an instructor reads of a session.
namespace filasofia::app {

/// One session of a cohort, or of the trainee's own past: its numbers without its samples.
struct Attempt {
    std::string trainee = {}, task = {}, date = {}, software = {};
    std::vector<metric::Value> values = {}; ///< in the catalog's order
    bool current = false;                   ///< it is the one that is reported
};
Attempt attemptOf(const metric::Session& session);

/// All that the page, the JSON and the CSV are made of.
struct Report {
    metric::Session session = {};
    std::string origin = {};                ///< the file's name, or what else it is
    std::vector<metric::Value> values = {}; ///< in the catalog's order
    std::vector<Attempt> own = {};          ///< the trainee's sessions of this case by rising date, this one too
    std::vector<Attempt> others = {};       ///< sessions of other trainees of this case
    std::vector<metric::Comparison> comparisons = {}; ///< with the others; empty without a cohort
    std::vector<std::string> leftOut = {};            ///< files of the cohort that could not be read
};
/// `cohort`: sessions of anybody and of any case; Error where none is of this case.
Report makeReport(metric::Session session, std::string origin, std::vector<Attempt> cohort = {});

/// Reads a session: `tool` and `threads` are for recordings (replayedSession()). Throws Error where it is neither a
/// session (.jsonl) nor a recording (.rec), is damaged or of another version.
metric::Session readAnySession(const std::filesystem::path& file, const std::string& tool, int threads);

/// Every session and recording in a folder, but for `except`; a recording with a session's name beside it is the same
/// once more. What cannot be read is told on stderr, and its name is added to `leftOut`. Throws Error where the folder
/// cannot be read, or holds none that can.
std::vector<Attempt> readCohort(const std::filesystem::path& folder, const std::filesystem::path& except,
                                const std::string& tool, int threads, std::vector<std::string>& leftOut);

/// A session of a case that is made by formulas, the same every time: skill [-] in [0, 1].
metric::Session exampleSession(const std::string& trainee, const std::string& date, double skill, unsigned seed);
/// A report of the last of five of them, among those of six other trainees.
Report exampleReport();

/// The session of a recording of steps: made again, its rigid bodies sampled. `tool`: the body that is measured; empty:
/// the first that is moved from outside. Throws Error where the file is no recording or has no such body.
metric::Session replayedSession(const std::filesystem::path& recording, const std::string& tool, int threads);

// Numbers for people: "12.3", in the unit that people read (mm, ml, degrees).
std::string shownNumber(double value, std::string_view unit);
std::string shownUnit(std::string_view unit);
/// Seconds as "1:02.5" or "3.250 s".
std::string shownTime(double seconds);
/// A name as it is shown: one line, not longer than 120 characters.
std::string shownName(const std::string& name);

std::string reportJson(const Report& report);
std::string reportCsv(const Report& report);
std::string reportText(const Report& report); ///< for a terminal
std::string reportPage(const Report& report); ///< one HTML file that needs nothing else

// Of the page.
/// What is not measured, and whose forces are known too.
std::vector<const metric::Track*> otherInstruments(const metric::Session& session);
std::string escaped(std::string_view text);     ///< in HTML, also within quotes
std::string plotData(const Report& report);     ///< JSON that may stand in a script element
std::string pathPictures(const Report& report); ///< the path in three projections, as SVG

} // namespace filasofia::app
