#include "filasofia/engine/piercing/followers.h"

#include "filasofia/engine/piercing/channels.h"
#include "filasofia/engine/scene/find_body.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

namespace filasofia::engine {
namespace {

// A rod follows a line if it is attached to the line's body no farther from the line's end than this many radii of
// both: a cable that is fixed elsewhere on an instrument does not run through the tissue behind its needle.
constexpr double kNear = 5.0;

/// The ends of a rod, its first node and its last, that an attachment ties to a body. A stump of one node is none.
struct TiedEnds {
    bool first = false, last = false;
};

TiedEnds tiedEnds(const Scene& scene, const Attachment& attachment, BodyId rod, BodyId to)
{
    const std::size_t side = attachment.body == rod ? 0 : 1;
    if ((side == 0 ? attachment.body : attachment.to) != rod || (side == 0 ? attachment.to : attachment.body) != to)
        return {};
    const auto place = findBody(scene, rod);
    if (!place || !place->soft || !isRod(scene.soft[place->index].model)) return {};
    const SoftModel& model = scene.soft[place->index].model;
    const std::size_t end = model.rest.size() - 1;
    if (model.rod.edges.size() != end) return {}; // a ring has no end
    const auto holds = [&](std::size_t node) {
        return std::ranges::any_of(attachment.pairs, [&](const std::array<AttachedPoint, 2>& pair) {
            return std::ranges::any_of(pair[side].nodes, [&](const NodeWeight& at) {
                return at.node == static_cast<int>(node) && at.weight > 0.5;
            });
        });
    };
    const Rod& line = model.rod;
    return {holds(0) && !isCut(line, 0), holds(end) && !isCut(line, end - 1)};
}

/// The rod that is tied to the end of a line.
std::optional<ThreadedLine> followerOf(const Scene& scene, const ThreadedLine& last)
{
    const LineShape front(scene, last);
    if (front.isCutOff()) return std::nullopt; // what is tied to its other end does not follow
    for (const Attachment& each : scene.attachments) {
        const BodyId rod = each.to == last.body ? each.body : each.to;
        const TiedEnds tied = tiedEnds(scene, each, rod, last.body);
        if (!tied.first && !tied.last) continue;
        const ThreadedLine next{rod, !tied.first, front.end()};
        const LineShape shape(scene, next);
        const double apart = length(shape.position(shape.begin()) - front.position(front.end()));
        if (apart <= kNear * (front.radius() + shape.radius())) return next;
    }
    return std::nullopt;
}

/// Whether a line of a channel is still tied to the one before it.
bool isTied(const Scene& scene, const ThreadedLine& front, const ThreadedLine& next)
{
    return std::ranges::any_of(scene.attachments, [&](const Attachment& each) {
        const TiedEnds tied = tiedEnds(scene, each, next.body, front.body);
        return next.reversed ? tied.last : tied.first;
    });
}

/// Parts a channel behind its line `index - 1`. What still runs through it keeps it; if both parts do, the part behind
/// gets a channel of its own, which is returned.
std::optional<Channel> partBehind(const Scene& scene, std::ptrdiff_t index, Channel& channel)
{
    const Threading now(scene, channel);
    const double start = channel.lines[static_cast<std::size_t>(index)].start;
    const auto isBehind = [&](double place) { return place >= start; };
    // From the entry on the places descend.
    const std::ptrdiff_t points = std::ranges::find_if_not(now.places, isBehind) - now.places.begin();
    const bool inFront =
        std::ranges::any_of(now.places, [&](double place) { return now.lines.occupied(place) && !isBehind(place); });
    if (points > 0 && !inFront) { // what is in front has left
        channel.lines.erase(channel.lines.begin(), channel.lines.begin() + index);
        return std::nullopt;
    }
    Channel behind = takeBehind(index, points, channel);
    if (points == 0) return std::nullopt; // what is behind has not come so far
    behind.through = false;
    return behind;
}

} // namespace

void follow(const Scene& scene, Channel& channel)
{
    while (findBody(scene, channel.lines.back().body)) {
        const auto next = followerOf(scene, channel.lines.back());
        if (!next || std::ranges::find(channel.lines, next->body, &ThreadedLine::body) != channel.lines.end()) return;
        channel.lines.push_back(*next);
    }
}

void partLines(Scene& scene)
{
    for (std::size_t c = 0; c < scene.channels.size(); ++c) { // a part behind is looked at in its turn
        std::vector<ThreadedLine>& lines = scene.channels[c].lines;
        const auto parted = std::ranges::adjacent_find(
            lines, [&](const ThreadedLine& front, const ThreadedLine& next) { return !isTied(scene, front, next); });
        if (parted == lines.end()) continue;
        const std::ptrdiff_t index = parted - lines.begin() + 1;
        if (auto behind = partBehind(scene, index, scene.channels[c])) scene.channels.push_back(std::move(*behind));
    }
}

} // namespace filasofia::engine
