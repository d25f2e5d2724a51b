#include "apps/filasofia/report.h"
#include "filasofia/core/text.h"
#include "filasofia/metric/motion.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace filasofia::app {
namespace {

using Json = nlohmann::ordered_json;

// Keeps a page of ten minutes at 1 kHz below a megabyte.
constexpr std::size_t kMaxPoints = 6000;
constexpr std::size_t kMaxPathPoints = 1500;
constexpr std::size_t kMaxEvents = 500;
constexpr int kBins = 24;

struct Series {
    std::vector<double> times, values; ///< NaN marks a gap
};

/// Keeps the smallest and the largest value of every stretch, in their order, so that no peak is lost.
Series thinned(const Series& series)
{
    const std::size_t n = series.times.size();
    if (n <= kMaxPoints) return series;
    Series out;
    const std::size_t stretches = kMaxPoints / 2;
    for (std::size_t k = 0; k < stretches; ++k) {
        const std::size_t first = k * n / stretches, end = (k + 1) * n / stretches;
        std::size_t low = first, high = first;
        for (std::size_t i = first; i < end; ++i) {
            if (!(series.values[i] >= series.values[low])) low = i; // also true for NaN, so that a gap is kept
            if (series.values[i] > series.values[high]) high = i;
        }
        for (const std::size_t i : {std::min(low, high), std::max(low, high)}) {
            if (!out.times.empty() && series.times[i] <= out.times.back()) continue;
            out.times.push_back(series.times[i]);
            out.values.push_back(series.values[i]);
        }
    }
    return out;
}

/// Rounds to five digits, which is more than a plot shows.
Json rounded(double value, double scale = 1.0)
{
    if (!std::isfinite(value)) return nullptr;
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.5g", value * scale);
    return Json(std::strtod(buffer, nullptr));
}
Json milliseconds(double time) { return std::isfinite(time) ? Json(std::round(time * 1e4) / 1e4) : Json(nullptr); }

Json seriesJson(const Series& full, double scale)
{
    const Series series = thinned(full);
    Json times = Json::array(), values = Json::array();
    for (std::size_t i = 0; i < series.times.size(); ++i) {
        times.push_back(milliseconds(series.times[i]));
        values.push_back(rounded(series.values[i], scale));
    }
    return Json::array({times, values});
}

Series speedOf(const metric::Track& tool)
{
    Series series;
    for (const metric::Motion& motion : metric::motionsOf(tool)) {
        if (!series.times.empty()) {
            series.times.push_back(std::nextafter(motion.start, -1e300));
            series.values.push_back(NAN);
        }
        for (std::size_t i = 0; i < motion.speeds.size(); ++i) {
            series.times.push_back(motion.timeAt(i));
            series.values.push_back(motion.speeds[i]);
        }
    }
    return series;
}

Series forceOf(const metric::Track& tool)
{
    Series series;
    for (const metric::Sample& sample : tool.samples)
        if (std::isfinite(sample.time) && (series.times.empty() || sample.time > series.times.back())) {
            series.times.push_back(sample.time);
            series.values.push_back(isFinite(sample.force) ? length(sample.force) : NAN);
        }
    return series;
}

/// Seconds in contact in each interval of force.
Json histogramJson(const metric::Track& tool)
{
    double largest = 0.0;
    for (const metric::Sample& sample : tool.samples)
        if (sample.contacts > 0 && isFinite(sample.force)) largest = std::max(largest, length(sample.force));
    if (!(largest > 1e-9) || !std::isfinite(largest)) return nullptr; // below a nanonewton there is nothing to see
    // Readable edges: multiples of 1, 2 or 5 times a power of ten.
    const double raw = largest / kBins, decade = std::pow(10.0, std::floor(std::log10(raw)));
    const double width = decade * (raw <= decade ? 1.0 : raw <= 2.0 * decade ? 2.0 : raw <= 5.0 * decade ? 5.0 : 10.0);
    std::vector<double> seconds(static_cast<std::size_t>(largest / width) + 1);
    for (std::size_t i = 1; i < tool.samples.size(); ++i) {
        const metric::Sample& sample = tool.samples[i];
        const double dt = sample.time - tool.samples[i - 1].time;
        if (sample.contacts <= 0 || !isFinite(sample.force) || !(dt > 0.0) || dt > metric::MeasureDef{}.maximumGap)
            continue;
        seconds[std::min(seconds.size() - 1, static_cast<std::size_t>(length(sample.force) / width))] += dt;
    }
    Json edges = Json::array(), bars = Json::array();
    for (std::size_t i = 0; i < seconds.size(); ++i) {
        edges.push_back(rounded((static_cast<double>(i) + 0.5) * width));
        bars.push_back(rounded(seconds[i]));
    }
    return {{"width", rounded(width)}, {"data", Json::array({edges, bars})}};
}

std::vector<metric::Sample> pathOf(const metric::Track& tool)
{
    std::vector<metric::Sample> path;
    for (const metric::Sample& sample : tool.samples)
        if (std::isfinite(sample.time) && isFinite(sample.pose.position) && length(sample.pose.position) < 1e6)
            path.push_back(sample);
    if (path.size() <= kMaxPathPoints) return path;
    std::vector<metric::Sample> few;
    for (std::size_t k = 0; k < kMaxPathPoints; ++k) few.push_back(path[k * (path.size() - 1) / (kMaxPathPoints - 1)]);
    return few;
}

Json curvesJson(const Report& report)
{
    Json curves = Json::array();
    for (std::size_t i = 0; i < report.values.size(); ++i) {
        const metric::MetricInfo& info = metric::catalog()[i];
        Json values = Json::array();
        int numbers = 0;
        for (const Attempt& attempt : report.own) {
            const auto& value = attempt.values[i].value;
            numbers += value ? 1 : 0;
            values.push_back(value ? Json(std::strtod(shownNumber(*value, info.unit).c_str(), nullptr))
                                   : Json(nullptr));
        }
        if (numbers == 0) continue;
        Json curve = {{"id", info.id}, {"name", info.name}, {"unit", shownUnit(info.unit)}, {"values", values}};
        if (!report.comparisons.empty() && report.comparisons[i].others > 0) {
            const metric::Comparison& c = report.comparisons[i];
            const auto shown = [&](double x) { return std::strtod(shownNumber(x, info.unit).c_str(), nullptr); };
            curve["mean"] = shown(c.mean);
            curve["deviation"] = shown(c.deviation);
        }
        curves.push_back(std::move(curve));
    }
    return curves;
}

/// One of three views: the coordinates that point right and up.
struct View {
    const char *name, *right, *up;
    Vec3 rightAxis, upAxis;
};
constexpr std::array kViews = {
    View{"From the front", "x", "y", {1, 0, 0}, {0, 1, 0}},
    View{"From the right", "−z", "y", {0, 0, -1}, {0, 1, 0}},
    View{"From above", "x", "−z", {1, 0, 0}, {0, 0, -1}},
};

std::string number(double value)
{
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.1f", value);
    return buffer;
}

/// A round length, about a quarter of `size` [m].
double roundLength(double size)
{
    const double raw = size / 4.0, decade = std::pow(10.0, std::floor(std::log10(raw)));
    return decade * (raw < 2.0 * decade ? 1.0 : raw < 5.0 * decade ? 2.0 : 5.0);
}

constexpr double kPicture = 240.0, kMargin = 18.0; // [px]

} // namespace

std::string plotData(const Report& report)
{
    const metric::Session& session = report.session;
    Json json = {{"events", Json::array()},
                 {"curves", curvesJson(report)},
                 {"dates", Json::array()},
                 {"current", 0},
                 {"otherForces", Json::array()}};
    for (const metric::Event& event : std::span(session.events).first(std::min(session.events.size(), kMaxEvents)))
        json["events"].push_back(
            {{"t", milliseconds(event.time)}, {"kind", metric::name(event.kind)}, {"what", shownName(event.what)}});
    for (std::size_t i = 0; i < report.own.size(); ++i) {
        json["dates"].push_back(shownName(report.own[i].date));
        if (report.own[i].current) json["current"] = i;
    }
    if (session.forceLimit) json["limit"] = *session.forceLimit;
    if (const metric::Track* tool = metric::findTrack(session, metric::Role::Tool)) {
        json["speed"] = seriesJson(speedOf(*tool), 1e3);
        if (tool->force) {
            json["force"] = seriesJson(forceOf(*tool), 1.0);
            json["histogram"] = histogramJson(*tool);
            for (const metric::Track* other : otherInstruments(session))
                json["otherForces"].push_back(seriesJson(forceOf(*other), 1.0));
        }
        Json times = Json::array();
        for (const metric::Sample& sample : pathOf(*tool)) times.push_back(milliseconds(sample.time));
        json["pathTimes"] = std::move(times);
    }
    const std::string plain = json.dump(-1, ' ', true, Json::error_handler_t::replace);
    std::string out; // nothing in it may end the script element that contains it
    for (const char letter : plain) out += letter == '<' ? "\\u003c" : std::string(1, letter);
    return out;
}

std::string pathPictures(const Report& report)
{
    const metric::Track* tool = metric::findTrack(report.session, metric::Role::Tool);
    const std::vector<metric::Sample> path = tool ? pathOf(*tool) : std::vector<metric::Sample>();
    if (path.size() < 2) return "<p class=\"absent\">No position of a tool was recorded.</p>\n";
    Vec3 low = path[0].pose.position, high = low;
    for (const metric::Sample& sample : path)
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], sample.pose.position[k]);
            high[k] = std::max(high[k], sample.pose.position[k]);
        }
    const Vec3 middle = 0.5 * (low + high), extent = high - low;
    const double size = std::max({extent.x, extent.y, extent.z, 1e-6}), scale = (kPicture - 2.0 * kMargin) / size;
    const double bar = roundLength(size);
    std::string out;
    for (const View& view : kViews) {
        const auto at = [&](const metric::Sample& sample) {
            const Vec3 p = sample.pose.position - middle;
            return text(number(0.5 * kPicture + scale * dot(p, view.rightAxis)), ',',
                        number(0.5 * kPicture - scale * dot(p, view.upAxis)));
        };
        std::string all, touching;
        bool touched = false;
        for (const metric::Sample& sample : path) {
            const std::string place = at(sample);
            all += place;
            all += ' ';
            if (sample.contacts > 0) touching.append(1, touched ? 'L' : 'M').append(place);
            touched = sample.contacts > 0;
        }
        const auto dot = [&](const char* kind, const metric::Sample& sample) {
            const std::string place = at(sample);
            const std::size_t comma = place.find(',');
            return text("<circle class=\"", kind, "\" r=\"4\" cx=\"", place.substr(0, comma), "\" cy=\"",
                        place.substr(comma + 1), "\"/>");
        };
        out += text("<figure><svg viewBox=\"0 0 240 240\" role=\"img\" aria-label=\"The tool's path, ", view.name,
                    "\"><polyline class=\"way\" points=\"", all, "\"/><path class=\"touching\" d=\"", touching, "\"/>",
                    dot("start", path.front()), dot("end", path.back()), dot("now", path.front()),
                    "<path class=\"bar\" d=\"M10 230h", number(bar * scale), "\"/><text x=\"10\" y=\"224\">",
                    shownNumber(bar, "m"), " mm</text><text class=\"axis\" x=\"230\" y=\"234\">", view.right,
                    " →</text><text class=\"axis\" x=\"230\" y=\"14\">", view.up, " ↑</text></svg><figcaption>",
                    view.name, "</figcaption></figure>\n");
    }
    return out;
}

} // namespace filasofia::app
