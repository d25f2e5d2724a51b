#include "filasofia/engine/piercing/channels.h"

#include "filasofia/engine/piercing/embed.h"
#include "filasofia/engine/piercing/threading.h"
#include "filasofia/engine/scene/find_body.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace filasofia::engine {
namespace {

// A point slides if its friction is at least this share of the largest.
constexpr double kSliding = 0.999;

/// The end of a rod that is attached to a line's body, so that the rod follows it through the channel.
std::optional<ThreadedLine> followerOf(const Scene& scene, const ThreadedLine& last)
{
    const LineShape front(scene, last);
    if (front.isCutOff()) return std::nullopt; // what is tied to its other end does not follow
    for (const Attachment& each : scene.attachments) {
        if (each.to != last.body && each.body != last.body) continue;
        const std::size_t side = each.to == last.body ? 0 : 1;
        const BodyId other = side == 0 ? each.body : each.to;
        const auto place = findBody(scene, other);
        if (!place || !place->soft || !isRod(scene.soft[place->index].model)) continue;
        const auto holds = [&](std::size_t node) {
            return std::ranges::any_of(each.pairs, [&](const std::array<AttachedPoint, 2>& pair) {
                return std::ranges::any_of(pair[side].nodes, [&](const NodeWeight& at) {
                    return at.node == static_cast<int>(node) && at.weight > 0.5;
                });
            });
        };
        const SoftModel& rod = scene.soft[place->index].model;
        const std::size_t end = rod.rest.size() - 1;
        if (rod.rod.edges.size() != end) continue; // a ring has no end
        if (holds(0) || holds(end)) return ThreadedLine{other, !holds(0), front.end()};
    }
    return std::nullopt;
}

/// Adds the rods behind the lines of a channel, as far as they have come to its entry.
void follow(const Scene& scene, const Threading& now, Channel& channel)
{
    if (now.places.empty()) return;
    double entry = now.places.front(), end = now.lines.end();
    while (entry > end && findBody(scene, channel.lines.back().body)) {
        const auto next = followerOf(scene, channel.lines.back());
        if (!next || std::ranges::find(channel.lines, next->body, &ThreadedLine::body) != channel.lines.end()) return;
        channel.lines.push_back(*next);
        const Threading longer(scene, channel);
        entry = longer.places.front();
        end = longer.lines.end();
    }
}

/// Lets the tip cut on to where it is now, less what its spring takes up.
void advanceTip(const Scene& scene, const LineShape& needle, Channel& channel)
{
    const SoftBody& tissue = scene.soft[findBody(scene, channel.tissue)->index];
    const std::vector<Vec3>& x = tissue.state.x;
    const Vec3 from = meanOf(channel.end, x), forward = needle.forward(0.0);
    const Vec3 to = needle.position(0.0) - giveOf(*tissue.model.puncture, needle) * forward;
    if (!(dot(to - from, forward) > 0.0)) return;
    // A new point takes over what its neighbour's spring has taken up, or friction would dip each time.
    const auto addPoint = [&] {
        const ChannelPoint& last = channel.points.back();
        const double strained = last.held - needle.nearest(meanOf(last.nodes, x), last.held);
        channel.points.push_back(
            {channel.end, needle.nearest(meanOf(channel.end, x), 0.0) + strained, last.slides, last.pressed});
        channel.travelled = 0.0;
    };
    if (const auto reached = embed(to, channel.end, tissue.model, x)) {
        channel.travelled += length(to - from);
        channel.end = *reached;
        if (channel.travelled >= spacingOf(scene, channel)) addPoint();
    } else if (length(from - meanOf(channel.points.front().nodes, x)) > 2.0 * needle.radius()) {
        // It has come out; a tip that has only just gone in may still be ahead of the surface around it.
        addPoint();
        channel.through = true;
    }
}

/// Takes the result of a constraint over into its channel.
void take(double dt, const Constraint& constraint, const Threading& now, Channel& channel, frame::Channel& report)
{
    const Vec3 impulse = isFinite(constraint.impulse) ? constraint.impulse : Vec3{};
    report.force += 1.0 / dt * inWorld(constraint.frame, impulse);
    if (constraint.kind == ConstraintKind::Tip) {
        report.tip = impulse.x / dt;
        return;
    }
    report.friction += impulse.x / dt;
    const auto k = static_cast<std::size_t>(constraint.channel.point);
    // The force says what the spring has taken up; the rest has slid.
    channel.points[k].held = now.places[k] - dt * impulse.x / constraint.softness;
    channel.points[k].slides = std::abs(impulse.x) >= kSliding * constraint.maxImpulse;
    channel.points[k].pressed = std::sqrt(impulse.y * impulse.y + impulse.z * impulse.z) / dt;
}

void reportPlaces(const Scene& scene, const Threading& now, frame::Channel& report)
{
    const Channel& channel = now.channel;
    report.tissue = channel.tissue;
    report.needle = channel.lines.front().body;
    report.entry = meanOf(channel.points.front().nodes, now.tissue.state.x);
    report.end = meanOf(channel.end, now.tissue.state.x);
    report.through = channel.through;
    report.length = now.length();
    if (!now.places.empty()) report.inside = bodyAt(scene, channel, now.places.front());
}

/// Whether nothing is in a channel any more: the tip was pulled out at the entry, or all lines through it.
bool isEmpty(const Threading& now)
{
    if (now.places.empty()) return true;
    for (std::size_t k = 0; k < now.places.size(); ++k)
        if (now.occupied(k)) return false;
    const double mouth = 2.0 * now.lines.at(now.lines.begin()).radius(); // a tip that goes in is not beyond it yet
    return now.places.front() < now.lines.begin() - mouth || now.places.front() > now.lines.end();
}

} // namespace

void keepChannels(double dt, const Coupling& coupling, Scene& scene)
{
    if (dt == 0.0) return;
    scene.channelReports.assign(scene.channels.size(), {});
    std::vector<Threading> now;
    for (const Channel& channel : scene.channels) now.emplace_back(scene, channel);
    for (const Constraint& each : coupling.channels()) {
        const std::size_t c = each.channel.channel;
        take(dt, each, now[c], scene.channels[c], scene.channelReports[c]);
    }
    std::vector<char> empty;
    for (std::size_t c = 0; c < scene.channels.size(); ++c) {
        Channel& channel = scene.channels[c];
        for (std::size_t k = 0; k < now[c].places.size(); ++k)
            if (!now[c].occupied(k)) channel.points[k] = {channel.points[k].nodes, now[c].places[k]};
        if (const LineShape* needle = now[c].cutting()) advanceTip(scene, *needle, channel);
        follow(scene, now[c], channel);
        const Threading after(scene, channel);
        reportPlaces(scene, after, scene.channelReports[c]);
        empty.push_back(isEmpty(after));
    }
    for (std::size_t c = scene.channels.size(); c-- > 0;)
        if (empty[c]) scene.channels.erase(scene.channels.begin() + static_cast<std::ptrdiff_t>(c));
}

void removeChannelsOf(BodyId id, Scene& scene)
{
    std::erase_if(scene.channels, [&](const Channel& each) { return each.tissue == id; });
    for (Channel& channel : scene.channels)
        if (channel.lines.front().body == id) channel.through = true; // nobody cuts on
}

} // namespace filasofia::engine
