#include "apps/filasofia/build_info.h"
#include "apps/filasofia/report.h"
#include "filasofia/core/text.h"
#include "filasofia/metric/csv.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>

namespace filasofia::app {
namespace {

using Json = nlohmann::ordered_json;

const char* const kBetter[] = {"lower", "higher", "neither"};

Json orNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json metricJson(const Report& report, std::size_t i)
{
    const metric::MetricInfo& info = metric::catalog()[i];
    const metric::Value& value = report.values[i];
    Json entry = {{"id", info.id},
                  {"name", info.name},
                  {"value", orNull(value.value)},
                  {"unit", info.unit},
                  {"moment", orNull(value.moment)},
                  {"better", kBetter[static_cast<int>(info.better)]},
                  {"definition", info.definition},
                  {"source", info.source},
                  {"evidence", metric::name(info.evidence)},
                  {"found", info.found}};
    if (!value.value) entry["reason"] = value.reason;
    if (report.comparisons.empty()) return entry;
    const metric::Comparison& comparison = report.comparisons[i];
    entry["z"] = orNull(comparison.z);
    entry["cohort"] = {{"sessions", comparison.others}, {"mean", comparison.mean}, {"deviation", comparison.deviation}};
    if (!comparison.z) entry["cohort"]["reason"] = comparison.reason;
    return entry;
}

} // namespace

std::string reportJson(const Report& report)
{
    const metric::Session& session = report.session;
    const metric::Event* unfinished = metric::findUnfinished(session);
    Json whole = {{"filasofia", kVersion},
                  {"session",
                   {{"trainee", session.trainee},
                    {"case", session.task},
                    {"date", session.date},
                    {"software", session.software},
                    {"seed", session.seed},
                    {"origin", report.origin},
                    {"lost", session.lost},
                    {"complete", session.complete},
                    {"unfinished", unfinished ? Json(unfinished->what) : Json(nullptr)}}},
                  {"metrics", Json::array()},
                  {"events", Json::array()},
                  {"sessions", Json::array()}};
    for (std::size_t i = 0; i < report.values.size(); ++i) whole["metrics"].push_back(metricJson(report, i));
    for (const metric::Event& event : session.events)
        whole["events"].push_back({{"time", event.time},
                                   {"kind", metric::name(event.kind)},
                                   {"what", event.what},
                                   {"amount", orNull(event.amount)}});
    for (const Attempt& attempt : report.own) {
        Json values = Json::object();
        for (std::size_t i = 0; i < attempt.values.size(); ++i)
            values[std::string(metric::catalog()[i].id)] = orNull(attempt.values[i].value);
        whole["sessions"].push_back({{"date", attempt.date}, {"current", attempt.current}, {"values", values}});
    }
    return whole.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string reportCsv(const Report& report)
{
    using metric::csvCell;
    const metric::Session& session = report.session;
    const std::string who = csvCell(session.trainee) + "," + csvCell(session.task) + "," + csvCell(session.date) + ",";
    const auto cell = [](const std::optional<double>& number) { return number ? text(*number) : std::string(); };
    std::string out = "trainee,case,date,id,name,value,unit,moment [s],z,cohort mean,cohort deviation,cohort sessions,"
                      "better,evidence,found,source,definition,reason\n";
    for (std::size_t i = 0; i < report.values.size(); ++i) {
        const metric::MetricInfo& info = metric::catalog()[i];
        const metric::Value& value = report.values[i];
        out += who + text(info.id, ',', csvCell(info.name), ',', cell(value.value), ',',
                          info.unit == "-" ? "" : info.unit, ',', cell(value.moment), ',');
        if (report.comparisons.empty() || report.comparisons[i].others == 0) {
            out += ",,,,";
        } else {
            const metric::Comparison& comparison = report.comparisons[i];
            out +=
                text(cell(comparison.z), ',', comparison.mean, ',', comparison.deviation, ',', comparison.others, ',');
        }
        out += text(kBetter[static_cast<int>(info.better)], ',', csvCell(metric::name(info.evidence)), ',',
                    csvCell(info.found), ',', csvCell(info.source), ',', csvCell(info.definition), ',',
                    csvCell(value.reason), '\n');
    }
    return out;
}

std::string reportText(const Report& report)
{
    const metric::Session& session = report.session;
    const auto shown = [](const std::string& name) { return name.empty() ? "not named" : shownName(name); };
    std::string out = text("trainee ", shown(session.trainee), ", case ", shown(session.task), ", ",
                           session.date.empty() ? "no date" : shownName(session.date), '\n');
    if (!session.complete) out += "the record of the session is incomplete\n";
    if (const metric::Event* event = metric::findUnfinished(session))
        out += text("the task was not finished: ", shownName(event->what), '\n');
    if (session.lost > 0) out += text(session.lost, " samples were lost\n");
    if (report.unfinished > 0)
        out += text("left out: ", report.unfinished, report.unfinished == 1 ? " session" : " sessions",
                    " of others in which the task was not finished\n");
    bool netForce = false; // whether its line is there
    for (std::size_t i = 0; i < report.values.size(); ++i) {
        const metric::MetricInfo& info = metric::catalog()[i];
        const metric::Value& value = report.values[i];
        if (!value.value) continue;
        netForce = netForce || info.id == "force_max";
        char line[200];
        const std::string number = shownValue(info, *value.value, session), unit = shownUnit(info.unit);
        std::snprintf(line, sizeof line, "  %-28s %10s %-5s", std::string(info.name).c_str(), number.c_str(),
                      unit.c_str());
        out += line;
        if (!report.comparisons.empty() && report.comparisons[i].z) {
            std::snprintf(line, sizeof line, "  z %+.2f", *report.comparisons[i].z);
            out += line;
        }
        out += '\n';
    }
    if (netForce)
        out += "Largest net force: of one instrument; contacts on opposite sides of it cancel. A trainer's total force "
               "adds all.\n";
    return out;
}

} // namespace filasofia::app
