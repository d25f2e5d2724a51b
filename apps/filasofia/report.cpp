#include "apps/filasofia/report.h"

#include "filasofia/core/error.h"
#include "filasofia/core/word.h"
#include "filasofia/metric/session_file.h"

#include <algorithm>
#include <iostream>
#include <map>
#include <numbers>

namespace filasofia::app {
namespace {

/// Keeps the sessions of one case. Throws Error if there is none.
void keepCase(std::vector<Attempt>& cohort, const std::string& task)
{
    std::map<std::string, int> cases;
    for (const Attempt& attempt : cohort) ++cases[attempt.task];
    std::erase_if(cohort, [&](const Attempt& attempt) { return attempt.task != task; });
    if (!cohort.empty()) return;
    std::string list;
    for (const auto& [name, count] : cases)
        list += text(list.empty() ? "" : ", ", count, " of '", shortened(name), "'");
    fail("report: the cohort has no session of the case '", shortened(task), "'; it has ", list);
}

} // namespace

Attempt attemptOf(const metric::Session& session)
{
    const bool unfinished = metric::findUnfinished(session) != nullptr;
    return {session.trainee, session.task, session.date, session.software, metric::measure(session), unfinished};
}

Report makeReport(metric::Session session, std::string origin, std::vector<Attempt> cohort)
{
    Report report{.session = std::move(session), .origin = std::move(origin)};
    report.values = metric::measure(report.session);
    const bool compared = !cohort.empty();
    if (compared) keepCase(cohort, report.session.task);
    const metric::Session& own = report.session;
    report.own = {
        {own.trainee, own.task, own.date, own.software, report.values, metric::findUnfinished(own) != nullptr, true}};
    for (Attempt& attempt : cohort)
        (attempt.trainee == report.session.trainee ? report.own : report.others).push_back(std::move(attempt));
    std::ranges::stable_sort(report.own, {}, &Attempt::date);
    report.unfinished = std::erase_if(report.others, [](const Attempt& each) { return each.unfinished; });
    if (!compared) return report;
    for (std::size_t i = 0; i < report.values.size(); ++i) {
        std::vector<double> numbers;
        for (const Attempt& other : report.others)
            if (other.values[i].value) numbers.push_back(*other.values[i].value);
        report.comparisons.push_back(metric::compare(report.values[i], numbers));
    }
    return report;
}

namespace {

/// The session with the named track as its tool. If the name is empty, the session is returned unchanged.
metric::Session measuring(metric::Session session, const std::string& tool, const std::string& file)
{
    if (tool.empty()) return session;
    std::string list;
    for (const metric::Track& track : session.tracks)
        list += text(list.empty() ? "" : ", ", "'", shortened(track.name), "'");
    const auto found = std::ranges::find(session.tracks, tool, &metric::Track::name);
    if (found == session.tracks.end())
        fail(shortened(file), ": --tool: the session has no '", shortened(tool), "'; it has ",
             list.empty() ? "nothing" : list);
    found->role = metric::Role::Tool;
    std::rotate(session.tracks.begin(), found, found + 1);
    return session;
}

} // namespace

metric::Session readAnySession(const std::filesystem::path& file, const std::string& tool, int threads)
{
    if (file.extension() == ".jsonl") return measuring(metric::readSession(file), tool, file.string());
    if (file.extension() != ".rec")
        fail("report: ", shortened(file.string()), " must be a session (.jsonl) or a recording (.rec)");
    return replayedSession(file, tool, threads);
}

std::vector<Attempt> readCohort(const std::filesystem::path& folder, const std::filesystem::path& except,
                                const std::string& tool, int threads, std::vector<std::string>& leftOut)
{
    namespace fs = std::filesystem;
    std::error_code problem;
    const std::string name = shortened(folder.string());
    if (!fs::is_directory(folder, problem))
        fail("report: --cohort ", name, fs::exists(folder, problem) ? ": is not a folder" : ": does not exist");
    // Sorted by name without extension, because the order within a folder is arbitrary.
    std::map<fs::path, fs::path> files;
    fs::directory_iterator each(folder, problem);
    if (problem) fail("report: --cohort ", name, ": ", problem.message());
    for (; each != fs::directory_iterator(); each.increment(problem)) {
        if (problem) break;
        const fs::path &file = each->path(), extension = file.extension();
        if (extension != ".jsonl" && extension != ".rec") continue;
        const fs::path session = fs::path(file).replace_extension();
        if (extension == ".jsonl" || !files.contains(session)) files[session] = file;
    }
    if (problem) fail("report: --cohort ", name, ": ", problem.message());
    std::erase_if(files, [&](const auto& named) { // the session itself, or its recording
        std::error_code gone;
        return named.second.stem() == except.stem() && fs::equivalent(folder, fs::absolute(except).parent_path(), gone);
    });
    if (files.empty()) fail("report: --cohort ", name, ": holds no other session (.jsonl) or recording (.rec)");
    // One damaged file must not stop the report of a whole class.
    std::vector<Attempt> cohort;
    for (const auto& [session, file] : files) try {
            cohort.push_back(attemptOf(readAnySession(file, tool, threads)));
        } catch (const Error& error) {
            std::cerr << "left out of the cohort: " << oneLine(error.what()) << '\n';
            leftOut.push_back(file.filename().string());
        }
    if (cohort.empty()) fail("report: --cohort ", name, ": none of its ", files.size(), " files can be read");
    return cohort;
}

namespace {

struct Shown {
    std::string_view unit, shown;
    double scale;
};
/// The units shown to people, beside the SI units in files.
constexpr Shown kShown[] = {
    {"m", "mm", 1e3},
    {"m/s", "mm/s", 1e3},
    {"m^2", "mm²", 1e6},
    {"m^3", "ml", 1e6},
    {"rad", "°", 180.0 / std::numbers::pi},
    {"N s", "N s", 1.0},
    {"-", "", 1.0},
};

} // namespace

std::vector<const metric::Track*> otherInstruments(const metric::Session& session)
{
    std::vector<const metric::Track*> others;
    for (const metric::Track& track : session.tracks)
        if (track.role != metric::Role::Other && track.force && &track != findTrack(session, metric::Role::Tool))
            others.push_back(&track);
    return others;
}

std::string shownUnit(std::string_view unit)
{
    for (const Shown& each : kShown)
        if (each.unit == unit) return std::string(each.shown);
    return std::string(unit);
}

std::string shownNumber(double value, std::string_view unit)
{
    for (const Shown& each : kShown)
        if (each.unit == unit) value *= each.scale;
    const double size = std::abs(value);
    if (value == 0.0) return "0";
    if (size < 1e6 && std::abs(value - std::round(value)) < 1e-9 * size) return text(std::round(value));
    const char* format = size >= 100.0  ? "%.0f"
                         : size >= 10.0 ? "%.1f"
                         : size >= 1.0  ? "%.2f"
                         : size >= 0.01 ? "%.3f"
                                        : "%.2g";
    char buffer[400]; // %.0f of the largest double has 309 digits
    std::snprintf(buffer, sizeof buffer, size >= 1e6 ? "%.3g" : format, value);
    return buffer;
}

namespace {

/// The share of the steps that were done is shown as their number.
double shownTimes(const metric::MetricInfo& info, const metric::Session& session)
{
    return info.id == "steps_done" ? static_cast<double>(session.steps.size()) : 1.0;
}

} // namespace

std::string shownValue(const metric::MetricInfo& info, double value, const metric::Session& session)
{
    std::string shown = shownNumber(value * shownTimes(info, session), info.unit);
    return info.id == "steps_done" ? text(shown, " of ", session.steps.size()) : shown;
}

std::string shownSpread(const metric::MetricInfo& info, const metric::Comparison& others,
                        const metric::Session& session)
{
    const double times = shownTimes(info, session);
    return text(shownNumber(times * others.mean, info.unit), " ± ", shownNumber(times * others.deviation, info.unit));
}

std::string shownTime(double seconds)
{
    char buffer[64];
    if (!(std::abs(seconds) < 1e7)) return text(seconds, " s");
    const auto minutes = static_cast<long>(seconds / 60.0);
    if (minutes < 1)
        std::snprintf(buffer, sizeof buffer, "%.2f s", seconds);
    else
        std::snprintf(buffer, sizeof buffer, "%ld:%05.2f", minutes, seconds - 60.0 * static_cast<double>(minutes));
    return buffer;
}

std::string shownName(const std::string& name)
{
    constexpr std::size_t longest = 120;
    std::string line = oneLine(name);
    if (line.size() <= longest) return line;
    std::size_t end = longest; // do not cut within a UTF-8 character
    while (end > 0 && (static_cast<unsigned char>(line[end]) & 0xc0) == 0x80) --end;
    return line.substr(0, end) + "…";
}

} // namespace filasofia::app
