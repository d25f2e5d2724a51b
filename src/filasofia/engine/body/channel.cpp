#include "filasofia/engine/body/channel.h"

#include "filasofia/geometry/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace filasofia::engine {

Channel takeBehind(std::ptrdiff_t line, std::ptrdiff_t points, Channel& channel)
{
    Channel behind = channel;
    channel.lines.erase(channel.lines.begin() + line, channel.lines.end());
    behind.lines.erase(behind.lines.begin(), behind.lines.begin() + line);
    channel.points.erase(channel.points.begin(), channel.points.begin() + points);
    behind.points.erase(behind.points.begin() + points, behind.points.end());
    if (!behind.points.empty()) behind.end = behind.points.back().nodes;
    return behind;
}

double distanceToPath(const Channel& channel, Vec3 place, const std::vector<Vec3>& x, std::size_t first)
{
    double least = std::numeric_limits<double>::infinity(); // squared
    Vec3 from = meanOf(channel.points[first].nodes, x);
    const auto visit = [&](const std::vector<NodeWeight>& point) {
        const Vec3 to = meanOf(point, x);
        least = std::min(least, geometry::nearestOnSegment(place, from, to).squaredDistance);
        from = to;
    };
    for (std::size_t k = first + 1; k < channel.points.size(); ++k) visit(channel.points[k].nodes);
    visit(channel.end);
    return std::sqrt(least);
}

} // namespace filasofia::engine
