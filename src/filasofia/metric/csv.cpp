#include "filasofia/metric/csv.h"

#include "filasofia/core/text.h"

#include <cmath>

namespace filasofia::metric {
namespace {

constexpr int kColumnsOfPose = 7, kColumnsOfForce = 7;

int columnsOf(const Session& session)
{
    int columns = 0;
    for (const Track& track : session.tracks) columns += kColumnsOfPose + (track.force ? kColumnsOfForce : 0);
    return columns;
}

void appendCell(std::string& out, double value)
{
    out += ',';
    if (std::isfinite(value)) out += text(value); // otherwise the cell is empty
}

} // namespace

std::string csvCell(std::string_view given)
{
    std::string cell = "\"";
    if (!given.empty() && std::string_view("=+-@\t\r\n").find(given.front()) != std::string_view::npos) cell += '\'';
    for (const char letter : oneLine(std::string(given))) cell += letter == '"' ? "\"\"" : std::string(1, letter);
    return cell + '"';
}

std::string csvHead(const Session& session)
{
    std::string out = "time [s]";
    for (const Track& track : session.tracks) {
        const auto add = [&](const char* column) { out += text(',', csvCell(text(track.name, ' ', column))); };
        for (const char* column : {"x [m]", "y [m]", "z [m]", "qw", "qx", "qy", "qz"}) add(column);
        if (!track.force) continue;
        for (const char* column : {"force x [N]", "force y [N]", "force z [N]", "contacts", "contact x [m]",
                                   "contact y [m]", "contact z [m]"})
            add(column);
    }
    return out + ",event,what,amount\n";
}

void appendCsvLine(std::string& out, const Session& session, std::span<const Sample> samples)
{
    out += samples.empty() ? "0" : text(samples.front().time);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Sample& sample = samples[i];
        const Vec3 &p = sample.pose.position, &f = sample.force, &c = sample.point;
        const Quat& q = sample.pose.orientation;
        for (const double value : {p.x, p.y, p.z, q.w, q.x, q.y, q.z}) appendCell(out, value);
        if (!session.tracks[i].force) continue;
        for (const double value : {f.x, f.y, f.z, static_cast<double>(sample.contacts), c.x, c.y, c.z})
            appendCell(out, value);
    }
    out += ",,,\n";
}

std::string csvLine(const Session& session, const Event& event)
{
    std::string out = text(event.time, std::string(static_cast<std::size_t>(columnsOf(session)), ','), ',',
                           csvCell(name(event.kind)), ',', csvCell(event.what), ',');
    if (event.amount && std::isfinite(*event.amount)) out += text(*event.amount);
    return out + '\n';
}

} // namespace filasofia::metric
