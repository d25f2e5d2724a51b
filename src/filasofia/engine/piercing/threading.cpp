#include "filasofia/engine/piercing/threading.h"

#include "filasofia/engine/scene/find_body.h"

#include <algorithm>

namespace filasofia::engine {

Vec3 meanOf(const std::vector<NodeWeight>& point, const std::vector<Vec3>& x)
{
    Vec3 sum;
    for (const NodeWeight& each : point) sum += each.weight * x[static_cast<std::size_t>(each.node)];
    return sum;
}

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
    const auto middle = [&](std::size_t a, std::size_t b) { return 0.5 * (places[a] + places[b]); };
    double front = lines.begin(), back = lines.end();
    if (k + 1 < places.size() && occupied(k + 1)) front = middle(k, k + 1);
    if (k + 1 == places.size() && channel.through) front = places[k];
    if (k == 0) back = places[k];
    if (k > 0 && occupied(k - 1)) back = middle(k, k - 1);
    return std::max(0.0, back - front);
}

double Threading::length() const
{
    double sum = 0.0;
    for (std::size_t k = 0; k < places.size(); ++k)
        if (occupied(k)) sum += lengthAt(k);
    return sum;
}

const LineShape* Threading::cutting() const
{
    return channel.through ? nullptr : lines.find(channel.lines.front().body);
}

double spacingOf(const Scene& scene, const Channel& channel)
{
    const auto place = findBody(scene, channel.lines.front().body);
    if (!place) return 0.0;
    if (!place->soft) return scene.rigid[place->index].model.needle->spacing;
    return scene.soft[place->index].model.rod.edges.front().restLength;
}

BodyId bodyAt(const Scene& scene, const Channel& channel, double place)
{
    BodyId body;
    for (const ThreadedLine& line : channel.lines)
        if (findBody(scene, line.body) && (!body || place >= line.start)) body = line.body;
    return body;
}

} // namespace filasofia::engine
