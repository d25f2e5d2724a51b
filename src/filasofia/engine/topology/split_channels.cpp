#include "filasofia/engine/topology/split_channels.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace filasofia::engine {
namespace {

/// The part of a channel behind a cut, which the channel itself loses.
struct Split {
    std::size_t line = 0;                    ///< the line that was cut
    double place = 0.0;                      ///< [m] where it was cut
    std::optional<ThreadedLine> front, back; ///< what is left of it on both sides, if it has an edge
};

/// The line of a channel that an edge belonged to, cut in two.
std::optional<Split> splitAt(const SoftBody& body, std::size_t edge, double s, const Channel& channel)
{
    const Rod& rod = body.model.rod;
    const std::size_t nodes = body.model.rest.size();
    if (edge + 1 >= nodes) return std::nullopt; // it closes a ring
    for (std::size_t l = 0; l < channel.lines.size(); ++l) {
        const ThreadedLine& line = channel.lines[l];
        if (line.body != body.model.id) continue;
        const auto edgeAt = [&](std::size_t k) { return line.reversed ? nodes - 2 - k : k; }; // between its corners
        const std::size_t cut = edgeAt(edge);
        if (cut < line.first) continue;
        double place = line.start;
        bool reached = true;
        for (std::size_t k = line.first; k < cut && reached; ++k) {
            reached = !isCut(rod, edgeAt(k));
            place += rod.edges[edgeAt(k)].restLength;
        }
        if (!reached) continue;
        const double length = rod.edges[edge].restLength;
        Split split{.line = l, .place = place + (line.reversed ? 1.0 - s : s) * length, .front = {}, .back = {}};
        if (cut > line.first) split.front = line;
        if (cut + 2 < nodes && !isCut(rod, edgeAt(cut + 1)))
            split.back = ThreadedLine{line.body, line.reversed, place + length, cut + 1};
        return split;
    }
    return std::nullopt;
}

} // namespace

void splitChannels(const SoftBody& rod, int edge, double s, Scene& scene)
{
    std::vector<Channel> channels;
    for (Channel& channel : scene.channels) {
        const auto split = splitAt(rod, static_cast<std::size_t>(edge), s, channel);
        if (!split) {
            channels.push_back(std::move(channel));
            continue;
        }
        const auto line = static_cast<std::ptrdiff_t>(split->line);
        auto at = channel.lines.erase(channel.lines.begin() + line);
        if (split->back) at = channel.lines.insert(at, *split->back);
        if (split->front) channel.lines.insert(at, *split->front);
        // Points lie from the entry on: what is farther behind the tip comes first.
        const auto isBehind = [&](const ChannelPoint& point) { return point.held > split->place; };
        const auto points = std::ranges::find_if_not(channel.points, isBehind) - channel.points.begin();
        Channel back = takeBehind(line + (split->front ? 1 : 0), points, channel);
        back.through = true;
        back.travelled = 0.0;
        for (Channel* each : {&channel, &back})
            if (!each->lines.empty() && !each->points.empty()) channels.push_back(std::move(*each));
    }
    scene.channels = std::move(channels);
}

} // namespace filasofia::engine
