#include "filasofia/engine/piercing/threading.h"

#include "filasofia/engine/scene/find_body.h"

#include <algorithm>

namespace filasofia::engine {
namespace {

// Tissue along a channel stretches to at most this; what is farther apart has been cut between.
constexpr double kStretched = 2.0;

} // namespace

Threading::Threading(const Scene& scene, const Channel& of)
    : channel(of), body(findBody(scene, of.tissue)->index), tissue(scene.soft[body]), lines(scene, of)
{
    if (lines.empty()) return;
    for (const ChannelPoint& point : channel.points) {
        // Beside a corner the nearest place is the corner, however a point moves there. What it is ahead of it, in the
        // mean direction of both sides, counts as way along the line: a taut thread would else leave its channel at a
        // sharp bend.
        const Vec3 x = meanOf(point.nodes, tissue.state.x);
        const double nearest = lines.nearest(x, point.held);
        const LineShape& line = lines.at(nearest);
        places.push_back(nearest - dot(x - line.position(nearest), line.forward(nearest)));
    }
}

double Threading::lengthAt(std::size_t k) const
{
    const std::vector<ChannelPoint>& points = channel.points;
    // Half of the way to a neighbour that a line runs through, else all of it, up to the line's front or tail.
    const auto part = [&](double way, double cut, bool shared) {
        return (shared ? 0.5 : 1.0) * std::clamp(way, 0.0, kStretched * cut);
    };
    double sum = 0.0;
    if (k + 1 < places.size()) {
        const bool shared = occupied(k + 1);
        sum += part(places[k] - (shared ? places[k + 1] : lines.begin()), points[k + 1].before, shared);
    } else if (!channel.through) {
        sum += part(places[k] - lines.begin(), channel.travelled + lines.at(lines.begin()).radius(), false);
    }
    if (k > 0) {
        const bool shared = occupied(k - 1);
        sum += part((shared ? places[k - 1] : lines.end()) - places[k], points[k].before, shared);
    }
    return sum;
}

double Threading::length() const
{
    double sum = 0.0;
    for (std::size_t k = 0; k < places.size(); ++k)
        if (occupied(k)) sum += lengthAt(k);
    return sum;
}

const LineShape* Threading::needle() const
{
    const LineShape* front = lines.find(channel.lines.front().body);
    return front && front->sharp() ? front : nullptr;
}

const LineShape* Threading::cutting() const { return channel.through ? nullptr : needle(); }

BodyId bodyAt(const Scene& scene, const Channel& channel, double place)
{
    BodyId body;
    for (const ThreadedLine& line : channel.lines)
        if (findBody(scene, line.body) && (!body || place >= line.start)) body = line.body;
    return body;
}

} // namespace filasofia::engine
