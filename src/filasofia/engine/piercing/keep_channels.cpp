#include "filasofia/engine/piercing/channels.h"

#include "filasofia/engine/piercing/embed.h"
#include "filasofia/engine/piercing/followers.h"
#include "filasofia/engine/scene/find_body.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace filasofia::engine {
namespace {

// A point slides if its friction is at least this share of the largest.
constexpr double kSliding = 0.999;

constexpr double kLost = 10.0; // radii from the mouth at which a tip is not about to go in

/// A needle that was drawn back and goes in again beside its path cuts a new one: the old one closes.
void leavePath(const Threading& now, const LineShape& needle, Channel& channel)
{
    const std::vector<Vec3>& x = now.tissue.state.x;
    const auto ahead = [&](double place) { return place < needle.begin(); };
    const auto inside = static_cast<std::size_t>(std::ranges::find_if(now.places, ahead) - now.places.begin());
    if (inside == 0) return; // the tip is not in the tissue
    // It has come out, and not back: wherever the tip is now, in another channel for example, it is not on this path.
    if (channel.through && inside == now.places.size()) return;
    const Vec3 tip = needle.position(needle.begin()), forward = needle.forward(needle.begin());
    if (dot(tip - meanOf(channel.end, x), forward) >= 0.0) return; // it cuts on
    const double far = 2.0 * needle.radius() + 0.5 * channel.spacing;
    if (distanceToPath(channel, tip, x, inside - 1) <= far) return;
    auto here = embed(tip - giveOf(now.law(), needle) * forward, channel.points[inside - 1].nodes, now.tissue.model, x);
    if (!here) return;
    channel.points.resize(inside);
    channel.end = std::move(*here);
    channel.travelled = length(meanOf(channel.end, x) - meanOf(channel.points.back().nodes, x));
    channel.through = false;
}

/// Adds a point at the deepest place. It takes over what its neighbour's spring has taken up, or friction would dip
/// each time.
void addPoint(const LineShape& needle, const std::vector<Vec3>& x, Channel& channel)
{
    const ChannelPoint& last = channel.points.back();
    const double strained = last.held - needle.nearest(meanOf(last.nodes, x), last.held);
    channel.points.push_back({.nodes = channel.end,
                              .before = channel.travelled,
                              .held = needle.nearest(meanOf(channel.end, x), needle.begin()) + strained,
                              .slides = last.slides,
                              .pressed = last.pressed});
    channel.travelled = 0.0;
}

/// Lets the tip cut on to where it is now, less what its spring takes up, and leaves points on the way.
void advanceTip(const SoftBody& tissue, const LineShape& needle, Channel& channel)
{
    const std::vector<Vec3>& x = tissue.state.x;
    const Vec3 from = meanOf(channel.end, x), forward = needle.forward(needle.begin());
    const Vec3 to = needle.position(needle.begin()) - giveOf(*tissue.model.puncture, needle) * forward;
    if (!(dot(to - from, forward) > 0.0)) return;
    const double way = length(to - from), pieces = std::ceil(way / channel.spacing);
    bool outside = false;
    for (double piece = 1.0; piece <= pieces; ++piece) {
        auto reached = embed(from + piece / pieces * (to - from), channel.end, tissue.model, x);
        outside = !reached;
        if (outside) continue;
        channel.end = std::move(*reached);
        channel.travelled += way / pieces;
        if (channel.travelled >= channel.spacing) addPoint(needle, x, channel);
    }
    // A tip that has only just gone in may still be ahead of the surface around it.
    const Vec3 entry = meanOf(channel.points.front().nodes, x);
    if (!outside || !(dot(to - entry, forward) > needle.radius())) return;
    if (channel.travelled > 0.0) addPoint(needle, x, channel);
    channel.through = true;
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
    // A tip that goes in is not beyond the mouth yet, and may be drawn back or to the side by a little.
    const LineShape& front = now.lines.at(now.lines.begin());
    const double begin = now.lines.begin(), radius = front.radius();
    const Vec3 entry = meanOf(now.channel.points.front().nodes, now.tissue.state.x);
    return now.places.front() < begin - 2.0 * radius || now.places.front() > now.lines.end() ||
           length(front.position(begin) - entry) > kLost * radius;
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
            if (ChannelPoint& point = channel.points[k]; !now[c].occupied(k))
                point = {.nodes = point.nodes, .before = point.before, .held = now[c].places[k]};
        if (const LineShape* needle = now[c].needle()) leavePath(now[c], *needle, channel);
        if (const LineShape* needle = now[c].cutting()) advanceTip(now[c].tissue, *needle, channel);
        follow(scene, channel);
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
}

} // namespace filasofia::engine
