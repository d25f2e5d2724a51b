#include "filasofia/engine/body/channel.h"

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

} // namespace filasofia::engine
