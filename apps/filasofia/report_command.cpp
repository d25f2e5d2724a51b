#include "apps/filasofia/command_line.h"
#include "apps/filasofia/commands.h"
#include "apps/filasofia/report.h"
#include "apps/filasofia/report_files.h"

#include "filasofia/core/error.h"

#include <algorithm>
#include <fstream>
#include <iostream>

namespace filasofia::app {
namespace {

struct Options {
    std::string file, cohort, html, json, csv, tool;
    int threads = 0;
    bool example = false, definitions = false;
};

constexpr const char* kPage = "filasofia_report.html"; // where nothing else is asked for

Report reportOf(const Options& options)
{
    if (options.example) {
        if (!options.file.empty()) fail("report: --example needs no file, got ", shownWord(options.file));
        if (!options.cohort.empty()) fail("report: --example brings its own cohort");
        return exampleReport();
    }
    if (options.file.empty()) fail("report: names no session; --example shows what a report is");
    metric::Session session = readAnySession(options.file, options.tool, options.threads);
    std::vector<Attempt> cohort;
    std::vector<std::string> leftOut;
    if (!options.cohort.empty())
        cohort = readCohort(options.cohort, options.file, options.tool, options.threads, leftOut);
    Report report =
        makeReport(std::move(session), std::filesystem::path(options.file).filename().string(), std::move(cohort));
    report.leftOut = std::move(leftOut);
    return report;
}

/// What was asked for may not take the place of a session, nor two of them the same place.
void checkOutputs(const Options& options)
{
    namespace fs = std::filesystem;
    std::vector<std::string> taken;
    for (const auto& [option, file] :
         {std::pair{"--html", options.html}, {"--json", options.json}, {"--csv", options.csv}}) {
        if (file.empty()) continue;
        if (const fs::path kind = fs::path(file).extension(); kind == ".jsonl" || kind == ".rec")
            fail("report: ", option, " ", shownWord(file),
                 ": is the name of a session or a recording: another, please");
        if (std::ranges::find(taken, file) != taken.end())
            fail("report: ", option, " ", shownWord(file), ": another output goes there");
        taken.push_back(file);
    }
}

/// "-" is standard output. A file that is there stays as it is until the new one is whole.
void write(const std::string& file, const std::string& content)
{
    if (file.empty()) return;
    if (file == "-") {
        std::cout << content;
        return;
    }
    std::error_code problem, none;
    // A device or a link is written to, and stays what it is.
    const std::filesystem::file_status there = std::filesystem::symlink_status(file, none);
    const bool direct = std::filesystem::exists(there) && !std::filesystem::is_regular_file(there);
    const std::string part = direct ? file : file + ".part";
    std::ofstream stream(part, std::ios::binary | std::ios::trunc);
    const bool opened = stream.is_open();
    stream << content;
    stream.close();
    if (stream && !direct) std::filesystem::rename(part, file, problem);
    if (!stream || problem) {
        if (opened && !direct) std::filesystem::remove(part, none);
        fail("report: ", oneLine(file), ": cannot be written", opened && !problem ? " (disk full?)" : "");
    }
    std::cerr << "wrote " << oneLine(file) << '\n';
}

int report(Options options)
{
    if (options.definitions) {
        std::cout << metric::catalogMarkdown();
        return 0;
    }
    checkOutputs(options);
    const Report report = reportOf(options);
    const bool piped = options.html == "-" || options.json == "-" || options.csv == "-";
    if (options.html.empty() && options.json.empty() && options.csv.empty()) options.html = kPage;
    if (!options.html.empty()) {
        write(options.html, reportPage(report));
        if (chartLibrary().empty())
            std::cerr << "filasofia: this program was built without uPlot: the page has no plots (scripts/setup.sh)\n";
    }
    if (!options.json.empty()) write(options.json, reportJson(report));
    if (!options.csv.empty()) write(options.csv, reportCsv(report));
    if (!piped) std::cout << reportText(report);
    return 0;
}

} // namespace

Command reportCommand()
{
    static Options options; // there is one command line, and it outlives this function
    return {.name = "report",
            .meaning = "Measure a session and write what an instructor reads: a page, JSON, CSV",
            .options = {{"FILE", &options.file, "A session (.jsonl, of a MetricTracker) or a recording (.rec)", "FILE"},
                        {"--example", &options.example,
                         "Report a session that is made by formulas, to see what a report is"},
                        {"--cohort", &options.cohort,
                         "A folder of sessions (.jsonl) and recordings (.rec, made again): the trainee's own make a "
                         "learning curve, "
                         "those of others z-scores",
                         "DIR"},
                        {.name = "--html",
                         .target = &options.html,
                         .meaning = "The page; - is standard output",
                         .type = "FILE",
                         .standard = std::string(kPage) + ", where no other file is asked for"},
                        {"--json", &options.json, "The same for programs; - is standard output", "FILE"},
                        {"--csv", &options.csv, "The same for spreadsheets; - is standard output", "FILE"},
                        {.name = "--tool",
                         .target = &options.tool,
                         .meaning = "What is to be measured: a rigid body of a recording, an instrument of a session",
                         .type = "NAME",
                         .standard = "the first that is moved from outside, of a session its first"},
                        {.name = "--threads",
                         .target = &options.threads,
                         .meaning = "Of a recording: threads within one step; 0: the cores but one, up to 8",
                         .bound = kThreads},
                        {"--definitions", &options.definitions, "Print the list of all measures (docs/metrics.md)"}},
            .run = [] { return report(options); },
            .footer = "docs/report.md says how to read it."};
}

} // namespace filasofia::app
