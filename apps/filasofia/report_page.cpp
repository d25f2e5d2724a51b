#include "apps/filasofia/build_info.h"
#include "apps/filasofia/report.h"
#include "apps/filasofia/report_files.h"
#include "filasofia/core/text.h"
#include "filasofia/metric/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace filasofia::app {
namespace {

/// The values shown at the top: the first that an instructor asks for. There is no overall score.
constexpr std::array kTiles = {"perforations", "force_max",   "force_over_time",        "tears_unintended",
                               "duration",     "path_length", "log_dimensionless_jerk", "steps_done"};

std::string momentButton(const std::optional<double>& moment)
{
    if (!moment) return {};
    const std::string time = shownTime(*moment);
    return text("<button type=\"button\" class=\"moment\" data-t=\"", *moment,
                "\" title=\"Show this moment in the plots\">", time, "</button>");
}

std::string withUnit(const std::string& number, std::string_view unit)
{
    const std::string shown = shownUnit(unit);
    return number + (shown.empty() ? "" : text("<span class=\"unit\"> ", shown, "</span>"));
}

std::string fact(const char* name, const std::string& value)
{
    return text("<div><dt>", name, "</dt><dd>", value, "</dd></div>\n");
}

/// [s] Time without samples of the tool; nothing is measured in it.
double timeInGaps(const metric::Session& session)
{
    const metric::Track* tool = metric::findTrack(session, metric::Role::Tool);
    const std::vector<metric::Motion> motions = tool ? metric::motionsOf(*tool) : std::vector<metric::Motion>();
    double gaps = 0.0;
    for (std::size_t i = 1; i < motions.size(); ++i)
        gaps += motions[i].start - (motions[i - 1].start + motions[i - 1].duration());
    return gaps;
}

std::string header(const Report& report)
{
    const metric::Session& session = report.session;
    const auto shown = [](const std::string& name, const char* otherwise) {
        return name.empty() ? std::string(otherwise) : escaped(shownName(name));
    };
    std::string out =
        text("<header>\n<p class=\"kind\">Session report</p>\n<h1>", shown(session.trainee, "Trainee not named"),
             "</h1>\n<p class=\"case\">", shown(session.task, "Case not named"), "</p>\n<dl class=\"facts\">\n");
    out += fact("Date", shown(session.date, "not recorded"));
    out += fact("Session", shown(report.origin, "–"));
    out += fact("Seed", text(session.seed));
    out += fact("Software", shown(session.software, "–"));
    if (const metric::Track* tool = metric::findTrack(session, metric::Role::Tool)) {
        out += fact("Tool", shown(tool->name, "–"));
        if (tool->samples.size() > 1) {
            const double rate = static_cast<double>(tool->samples.size() - 1) /
                                (tool->samples.back().time - tool->samples.front().time);
            out += fact("Samples",
                        text(tool->samples.size(), std::isfinite(rate) ? text(" at ", std::round(rate), " Hz") : ""));
        }
    }
    if (const double gaps = timeInGaps(session); gaps > 0.0) out += fact("Gaps", shownTime(gaps));
    out += fact("Lost", session.lost == 0 ? "none" : text(session.lost, " samples"));
    out += "</dl>\n";
    if (!session.complete)
        out += "<p class=\"warning\">The record of this session is incomplete. All numbers describe the part that was "
               "recorded.</p>\n";
    if (const metric::Event* event = metric::findUnfinished(session))
        out += text("<p class=\"warning\">The task was not finished: ", escaped(shownName(event->what)), ".</p>\n");
    if (session.lost > 0)
        out += "<p class=\"warning\">Samples were lost because the disk did not keep up. Gaps are left out of every "
               "number.</p>\n";
    return out + "</header>\n";
}

std::string tiles(const Report& report)
{
    std::string out = "<section class=\"tiles\" aria-label=\"Summary\">\n";
    for (const char* id : kTiles)
        for (std::size_t i = 0; i < report.values.size(); ++i) {
            const metric::MetricInfo& info = metric::catalog()[i];
            if (info.id != id || !report.values[i].value) continue;
            out += text("<div class=\"tile\"><p class=\"name\">", info.name, "</p><p class=\"value\">",
                        withUnit(shownValue(info, *report.values[i].value, report.session), info.unit),
                        "</p><p class=\"beside\">");
            if (!report.comparisons.empty() && report.comparisons[i].others > 0)
                out += text("others ", shownSpread(info, report.comparisons[i], report.session));
            else if (report.values[i].moment)
                out += text("at ", shownTime(*report.values[i].moment));
            out += "</p></div>\n";
        }
    return out + "</section>\n";
}

/// A strip that shows where z lies between -3 and 3.
std::string strip(double z, metric::Better better)
{
    const double x = 50.0 + 46.0 * std::clamp(z, -3.0, 3.0) / 3.0;
    const bool good = better == metric::Better::Lower ? z < 0.0 : z > 0.0;
    const char* kind = better == metric::Better::Neither ? "neither" : good ? "better" : "worse";
    return text("<svg class=\"strip ", kind,
                "\" viewBox=\"0 0 100 14\" aria-hidden=\"true\"><path d=\"M4 7h92M50 2v10\"/>"
                "<circle cx=\"",
                x, "\" cy=\"7\" r=\"4\"/></svg>");
}

std::string comparison(const Report& report, std::size_t i)
{
    const metric::MetricInfo& info = metric::catalog()[i];
    const metric::Comparison& c = report.comparisons[i];
    if (!c.z) return text("<span class=\"absent\">", escaped(c.reason), "</span>");
    char z[32];
    std::snprintf(z, sizeof z, "%+.2f", *c.z);
    return text(strip(*c.z, info.better), "<span class=\"z\">z ", z, "</span><span class=\"spread\">",
                shownSpread(info, c, report.session), ", n = ", c.others, "</span>");
}

std::string_view evidenceClass(metric::Evidence evidence)
{
    constexpr std::array kClasses = {"yes", "no", "unknown", "safety"};
    return kClasses[static_cast<std::size_t>(evidence)];
}

std::string row(const Report& report, std::size_t i)
{
    const metric::MetricInfo& info = metric::catalog()[i];
    const metric::Value& value = report.values[i];
    const char* better = info.better == metric::Better::Lower    ? " Lower is better."
                         : info.better == metric::Better::Higher ? " Higher is better."
                                                                 : "";
    std::string out = text("<tr id=\"", info.id, "\"><th scope=\"row\">", info.name, "<p class=\"definition\">",
                           escaped(info.definition), better, "</p></th><td data-label=\"Value\" class=\"number\">");
    out += value.value ? withUnit(shownValue(info, *value.value, report.session), info.unit)
                       : text("<span class=\"absent\">", escaped(value.reason), "</span>");
    out += text("</td><td data-label=\"Moment\">", momentButton(value.moment), "</td>");
    if (!report.comparisons.empty()) out += text("<td data-label=\"Others\">", comparison(report, i), "</td>");
    return out + text("<td data-label=\"Evidence\"><span class=\"badge ", evidenceClass(info.evidence), "\">",
                      metric::name(info.evidence), "</span><p class=\"found\">", escaped(info.found),
                      "</p><p class=\"source\">Source: ", escaped(info.source), "</p></td></tr>\n");
}

std::string metricTables(const Report& report)
{
    std::string out = "<section id=\"metrics\">\n<h2>All measures</h2>\n";
    std::optional<metric::Group> group;
    for (std::size_t i = 0; i < report.values.size(); ++i) {
        const metric::MetricInfo& info = metric::catalog()[i];
        if (group != info.group)
            out += text(group ? "</tbody></table>\n" : "", "<h3>", metric::name(info.group),
                        "</h3>\n<table><thead><tr><th scope=\"col\">Measure</th><th scope=\"col\">Value</th>"
                        "<th scope=\"col\">Moment</th>",
                        report.comparisons.empty() ? "" : "<th scope=\"col\">Other trainees</th>",
                        "<th scope=\"col\">Tells novices from experts?</th></tr></thead><tbody>\n");
        group = info.group;
        out += row(report, i);
    }
    return out + "</tbody></table>\n</section>\n";
}

const char* unitOf(metric::EventKind kind)
{
    using enum metric::EventKind;
    switch (kind) {
    case Tear:
    case Cut:
    case Burn:
        return "m^2";
    case Removed:
    case Blood:
        return "m^3";
    case Energy:
        return "J";
    case Activation:
    case InAir:
        return "s";
    default:
        return "-";
    }
}

std::string eventTable(const Report& report)
{
    if (report.session.events.empty()) return "<p class=\"absent\">No event was recorded.</p>\n";
    constexpr std::size_t kMaxRows = 500;
    std::string out = "<table class=\"events\"><thead><tr><th scope=\"col\">Moment</th><th scope=\"col\">Event</th>"
                      "<th scope=\"col\">What</th><th scope=\"col\">How much</th></tr></thead><tbody>\n";
    std::size_t count = 0;
    for (const metric::Event& event : report.session.events) {
        if (++count > kMaxRows) break;
        const std::string amount =
            event.amount ? withUnit(shownNumber(*event.amount, unitOf(event.kind)), unitOf(event.kind)) : "";
        out += text("<tr><td data-label=\"Moment\">", momentButton(event.time),
                    "</td><td data-label=\"Event\"><span class=\"kind ", metric::name(event.kind), "\">",
                    metric::name(event.kind), "</span></td><td data-label=\"What\">", escaped(shownName(event.what)),
                    "</td><td data-label=\"How much\">", amount, "</td></tr>\n");
    }
    out += "</tbody></table>\n";
    if (count > kMaxRows) out += text("<p>The first ", kMaxRows, " of ", report.session.events.size(), ".</p>\n");
    return out;
}

/// The empty element into which the script draws a plot.
std::string plot(const char* id, const char* label)
{
    return text("<div class=\"plot\" id=\"", id, "\" role=\"img\" aria-label=\"", label, "\"></div>\n");
}

/// A key that tells which line of the force plot belongs to which instrument.
std::string otherForces(const metric::Session& session)
{
    const metric::Track* tool = metric::findTrack(session, metric::Role::Tool);
    std::string names;
    for (const metric::Track* other : otherInstruments(session))
        names += (names.empty() ? "" : ", ") + escaped(shownName(other->name));
    if (tool == nullptr || names.empty()) return {};
    return text("<p class=\"hint\"><span class=\"key touching\"></span> ", escaped(shownName(tool->name)),
                " <span class=\"key others\"></span> ", names, "</p>\n");
}

std::string plots(const Report& report)
{
    const bool drawn = !chartLibrary().empty();
    std::string out = "<section id=\"time\">\n<h2>Over time</h2>\n";
    if (drawn)
        out += text("<p class=\"hint\">Point at a moment to see it in all plots. Drag to zoom, double-click to reset. "
                    "Click on a time in a table to see it here.</p>\n<p id=\"readout\" role=\"status\"></p>\n",
                    plot("speed", "Speed of the tool's tip over time"), plot("force", "Force over time"),
                    otherForces(report.session));
    else
        out += "<p class=\"warning\">This program was built without plots, because uPlot was missing when it was "
               "configured "
               "(scripts/setup.sh fetches it).</p>\n";
    out += text("</section>\n<section id=\"path\">\n<h2>Path of the tip</h2>\n<p class=\"hint\"><span class=\"key "
                "start\"></span> "
                "start <span class=\"key end\"></span> end <span class=\"key touching\"></span> in contact</p>\n"
                "<div class=\"views\">\n",
                pathPictures(report), "</div>\n</section>\n");
    if (drawn)
        out += text("<section id=\"forces\">\n<h2>Time in contact by force</h2>\n",
                    plot("histogram", "Seconds in contact at each force"), "</section>\n");
    return out;
}

std::string learning(const Report& report)
{
    std::string out = "<section id=\"learning\">\n<h2>Learning curve</h2>\n";
    if (report.own.size() < 2)
        return out + "<p class=\"absent\">There is only one session of this trainee and case, so there is no curve. "
                     "--cohort names a folder "
                     "with further sessions.</p>\n</section>\n";
    if (chartLibrary().empty())
        return out + "<p class=\"absent\">This program was built without plots.</p>\n</section>\n";
    return out + text("<p><label>Measure <select id=\"which\"></select></label></p>\n",
                      plot("curve", "A measure over the trainee's sessions"), "</section>\n");
}

/// The software versions of the compared sessions, if they differ.
std::string otherMakers(const Report& report)
{
    std::set<std::string> makers;
    for (const auto* sessions : {&report.own, &report.others})
        for (const Attempt& attempt : *sessions) makers.insert(shownName(attempt.software));
    std::string list;
    if (makers.size() > 1)
        for (const std::string& maker : makers)
            list += (list.empty() ? "" : ", ") + (maker.empty() ? "not recorded" : maker);
    return list;
}

std::string notes(const Report& report)
{
    std::string out =
        "<section id=\"notes\">\n<h2>How to read this</h2>\n<ul>\n"
        "<li>Every number has a definition, a source, and a summary of what studies found. "
        "<em>Discriminates</em>: at least one study could tell novices from experts by it, on its own simulator "
        "and task; this says nothing about the simulator used here.</li>\n"
        "<li>There is no overall score, because no study known to us supports one for this simulator.</li>\n"
        "<li>Compare only sessions of the same case. A single session says little; a curve says more.</li>\n"
        "<li>Rating scales (GOALS, Vassiliou 2005; OSATS, Martin 1997) are filled in by people; this report does "
        "not replace them.</li>\n"
        "<li>Positions are low-pass filtered at 20 Hz before speeds and jerks are computed. Force peaks are peaks "
        "of means over 5 ms. Gaps longer than 0.1 s are left out.</li>\n";
    if (!report.comparisons.empty())
        out += text("<li>z: the distance in standard deviations from the mean of ", report.others.size(),
                    " sessions of other trainees of the same case. It ranks; it does not judge.</li>\n");
    if (report.unfinished > 0)
        out += text("<li>", report.unfinished, report.unfinished == 1 ? " session" : " sessions",
                    " of other trainees in which the task was not finished: left out.</li>\n");
    for (const std::string& file : report.leftOut)
        out += text("<li>The cohort's file ", escaped(shownName(file)), " could not be read and is left out.</li>\n");
    if (const std::string makers = otherMakers(report); !makers.empty())
        out += text("<li>The sessions were recorded with different software: ", escaped(makers),
                    ". Differences between the versions may show in the numbers.</li>\n");
    return out + "</ul>\n</section>\n";
}

} // namespace

std::string escaped(std::string_view text)
{
    std::string out;
    for (const char letter : text) switch (letter) {
        case '&':
            out += "&amp;";
            break;
        case '<':
            out += "&lt;";
            break;
        case '>':
            out += "&gt;";
            break;
        case '"':
            out += "&quot;";
            break;
        case '\'':
            out += "&#39;";
            break;
        default:
            out += letter;
        }
    return out;
}

std::string reportPage(const Report& report)
{
    const std::string title =
        report.session.trainee.empty() ? "Session report" : "Session report: " + shownName(report.session.trainee);
    std::string out =
        text("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
             // Nothing is fetched from elsewhere, whatever a name contains.
             "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
             "script-src 'unsafe-inline'; img-src data:\">\n<meta name=\"viewport\" content=\"width=device-width, "
             "initial-scale=1\">\n<title>",
             escaped(title), "</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n", chartStyle(), "\n",
             pageStyle(), "</style>\n</head>\n<body>\n");
    out += header(report);
    out += "<main>\n" + tiles(report) + plots(report) + learning(report) + metricTables(report);
    out += "<section id=\"events\">\n<h2>Events</h2>\n" + eventTable(report) + "</section>\n" + notes(report);
    out += text("</main>\n<footer><p>Filasofia ", kVersion, "</p></footer>\n");
    if (!chartLibrary().empty())
        // The library reads the pixel ratio of the screen. Paper has a higher resolution, so it should draw at least at
        // ratio 2.
        out += text("<script type=\"application/json\" id=\"data\">", plotData(report),
                    "</script>\n<!-- The plots are drawn by uPlot:\n", chartLicence(),
                    "-->\n<script>\nconst uPlot = (devicePixelRatio => {\n", chartLibrary(),
                    "\nreturn uPlot;\n})(Math.max(2, window.devicePixelRatio));\n</script>\n<script>\n", pageScript(),
                    "</script>\n");
    return out + "</body>\n</html>\n";
}

} // namespace filasofia::app
