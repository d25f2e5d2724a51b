#include "filasofia/metric/measure.h"

#include "filasofia/core/text.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace filasofia::metric {
namespace {

bool watched(const Material& m, EventKind kind)
{
    return std::ranges::find(m.session.watched, kind) != m.session.watched.end();
}

std::vector<const Event*> eventsOf(const Material& m, const std::function<bool(const Event&)>& wanted)
{
    std::vector<const Event*> events;
    for (const Event& event : m.session.events)
        if (wanted(event)) events.push_back(&event);
    return events;
}

std::optional<double> firstOf(const std::vector<const Event*>& events)
{
    return events.empty() ? std::nullopt : std::optional(events.front()->time);
}

Value notWatched(EventKind kind) { return none(text("the session did not record events of kind '", name(kind), "'")); }

Value count(const Material& m, EventKind kind, const std::function<bool(const Event&)>& wanted)
{
    if (!watched(m, kind)) return notWatched(kind);
    const auto events = eventsOf(m, [&](const Event& event) { return event.kind == kind && wanted(event); });
    return found(static_cast<double>(events.size()), firstOf(events));
}

bool anyOf(const Event&) { return true; }

/// A blade that is drawn through a body, or a tear that propagates, opens it edit by edit: that counts as one act.
Value countActs(const Material& m, EventKind kind, const std::function<bool(const Event&)>& wanted)
{
    if (!watched(m, kind)) return notWatched(kind);
    const auto events = eventsOf(m, [&](const Event& event) { return event.kind == kind && wanted(event); });
    std::map<std::string_view, double> last; // [s], per body
    int acts = 0;
    for (const Event* event : events) {
        const auto [before, first] = last.try_emplace(event->what, event->time);
        if (first || event->time > before->second + m.def.rupturePause) ++acts;
        before->second = event->time;
    }
    return found(acts, firstOf(events));
}

std::function<bool(const Event&)> unintended(const Material& m)
{
    return [&targets = m.session.targets](const Event& event) {
        return std::ranges::find(targets, event.what) == targets.end();
    };
}

/// The newest amount of a kind that is reported repeatedly as it changes.
Value newestAmount(const Material& m, EventKind kind)
{
    const auto events = eventsOf(m, [&](const Event& event) { return event.kind == kind && event.amount; });
    if (events.empty()) return none(text("there was no event of kind '", name(kind), "'"));
    return found(*events.back()->amount, events.back()->time);
}

constexpr const char* kNoElectrode = "the case has no electrode";

/// The sum over bodies of an amount that is reported as it grows.
Value grown(const Material& m, EventKind kind, const char* absent)
{
    const auto events = eventsOf(m, [kind](const Event& event) { return event.kind == kind && event.amount; });
    if (events.empty()) return none(absent);
    std::map<std::string_view, double> last; // per body; one that is reset begins at 0 again
    double sum = 0.0;
    std::optional<double> first;
    for (const Event* event : events) {
        double& before = last[event->what];
        const double more = *event->amount - (*event->amount < before ? 0.0 : before);
        if (more > 0.0 && !first) first = event->time;
        sum += more;
        before = *event->amount;
    }
    return found(sum, first);
}

std::string noScope(const Material& m)
{
    if (!m.scope) return "no scope was observed";
    return m.scope->samples.size() < 2 ? "needs at least two samples of the scope" : "";
}

/// Calls take(i, dt) for every sample of the scope that ends an interval without a gap.
template <class Take> void forEachStep(const Material& m, const std::vector<Sample>& samples, Take&& take)
{
    for (std::size_t i = 1; i < samples.size(); ++i) {
        const double dt = samples[i].time - samples[i - 1].time;
        if (dt > 0.0 && dt <= m.def.maximumGap) take(i, dt);
    }
}

} // namespace

Value perforations(const Material& m) { return count(m, EventKind::Perforation, anyOf); }
Value unintendedTears(const Material& m) { return countActs(m, EventKind::Tear, unintended(m)); }
Value unintendedCuts(const Material& m) { return countActs(m, EventKind::Cut, unintended(m)); }

Value unintendedArea(const Material& m)
{
    if (!watched(m, EventKind::Tear)) return notWatched(EventKind::Tear);
    if (!watched(m, EventKind::Cut)) return notWatched(EventKind::Cut);
    const auto wrong = unintended(m);
    const auto events = eventsOf(m, [&](const Event& event) {
        return (event.kind == EventKind::Tear || event.kind == EventKind::Cut) && event.amount && wrong(event);
    });
    double area = 0.0;
    for (const Event* event : events) area += *event->amount;
    return found(area, firstOf(events));
}

Value bloodLost(const Material& m) { return grown(m, EventKind::Blood, "the case has no body that can bleed"); }

Value ductLeak(const Material& m) { return grown(m, EventKind::Leak, "the case has no duct"); }

/// The largest: an outflow that is opened wide gives back what had stretched the cavity.
Value fluidDeficit(const Material& m)
{
    const auto events =
        eventsOf(m, [](const Event& event) { return event.kind == EventKind::Deficit && event.amount; });
    if (events.empty()) return none("no fluid distends a cavity");
    double most = 0.0; // [m^3]
    for (const Event* event : events) most = std::max(most, *event->amount);
    return found(most, std::nullopt);
}

Value clipsPlaced(const Material& m) { return count(m, EventKind::Clip, anyOf); }
Value clipsLost(const Material& m) { return count(m, EventKind::ClipLost, anyOf); }
Value clipsSlipped(const Material& m) { return count(m, EventKind::ClipSlipped, anyOf); }

/// The largest burnt area of each body, because what is cut off later was burnt all the same.
Value unintendedBurn(const Material& m)
{
    const auto events = eventsOf(m, [](const Event& event) { return event.kind == EventKind::Burn && event.amount; });
    if (events.empty()) return none("the case has no body that burns and is no target");
    std::map<std::string_view, double> largest; // [m^2], per body
    std::optional<double> first;
    for (const Event* event : events) {
        if (*event->amount > 0.0 && !first) first = event->time;
        largest[event->what] = std::max(largest[event->what], *event->amount);
    }
    double area = 0.0;
    for (const auto& [body, most] : largest) area += most;
    return found(area, first);
}

Value activationTime(const Material& m) { return grown(m, EventKind::Activation, kNoElectrode); }
Value activationInAir(const Material& m) { return grown(m, EventKind::InAir, kNoElectrode); }
Value energyDelivered(const Material& m) { return grown(m, EventKind::Energy, kNoElectrode); }

Value volumeRemoved(const Material& m)
{
    if (!watched(m, EventKind::Removed)) return notWatched(EventKind::Removed);
    const auto events =
        eventsOf(m, [](const Event& event) { return event.kind == EventKind::Removed && event.amount; });
    double volume = 0.0;
    for (const Event* event : events) volume += *event->amount;
    return found(volume, firstOf(events));
}

Value horizonError(const Material& m)
{
    if (std::string reason = noScope(m); !reason.empty()) return none(reason);
    double sum = 0.0, time = 0.0;
    forEachStep(m, m.scope->samples, [&](std::size_t i, double dt) {
        const Pose& pose = m.scope->samples[i].pose;
        if (!isFinite(pose)) return;
        const Vec3 forward = normalized(rotate(pose.orientation, m.scope->axis));
        const Vec3 vertical = m.session.up - dot(m.session.up, forward) * forward;
        const Vec3 up = rotate(pose.orientation, m.scope->up);
        if (length(vertical) < 0.1 * length(m.session.up)) return; // it looks straight up or down: there is no horizon
        sum += dt * std::abs(std::atan2(dot(forward, cross(vertical, up)), dot(vertical, up)));
        time += dt;
    });
    return time > 0.0 ? found(sum / time) : none("the scope had no horizon at any time");
}

Value lensContactTime(const Material& m)
{
    if (std::string reason = noScope(m); !reason.empty()) return none(reason);
    if (!m.scope->force) return none("the scope's contacts were not observed");
    double time = 0.0;
    std::optional<double> first;
    forEachStep(m, m.scope->samples, [&](std::size_t i, double dt) {
        const Sample& sample = m.scope->samples[i];
        // A comparison with NaN is false.
        if (sample.contacts <= 0 || !(distance(sample.point, sample.pose.position) <= m.def.lensReach)) return;
        if (!first) first = sample.time - dt;
        time += dt;
    });
    return found(time, first);
}

Value outOfViewTime(const Material& m)
{
    if (std::string reason = noScope(m); !reason.empty()) return none(reason);
    if (!m.tool) return none("no tool was observed");
    if (!m.session.fieldOfView) return none("the case specifies no field of view");
    if (m.tool->samples.size() != m.scope->samples.size()) return none("tool and scope were not observed together");
    double time = 0.0;
    std::optional<double> first;
    forEachStep(m, m.scope->samples, [&](std::size_t i, double dt) {
        const Pose& scope = m.scope->samples[i].pose;
        const Vec3 to = m.tool->samples[i].pose.position - scope.position;
        if (!isFinite(scope) || !isFinite(to)) return;
        const Vec3 forward = rotate(scope.orientation, m.scope->axis);
        if (std::atan2(length(cross(forward, to)), dot(forward, to)) <= 0.5 * *m.session.fieldOfView) return;
        if (!first) first = m.scope->samples[i].time - dt;
        time += dt;
    });
    return found(time, first);
}

Value shareSeen(const Material& m) { return newestAmount(m, EventKind::Seen); }

Value stepsDone(const Material& m)
{
    if (m.session.steps.empty()) return none("the case specifies no steps");
    double done = 0.0;
    std::optional<double> last;
    for (const std::string& step : m.session.steps) {
        const auto events =
            eventsOf(m, [&](const Event& event) { return event.kind == EventKind::Step && event.what == step; });
        if (events.empty()) continue;
        done += 1.0;
        last = std::max(last.value_or(events.front()->time), events.front()->time);
    }
    return found(done / static_cast<double>(m.session.steps.size()), last);
}

Value mistakes(const Material& m) { return count(m, EventKind::Mistake, anyOf); }
Value residual(const Material& m) { return newestAmount(m, EventKind::Residual); }

} // namespace filasofia::metric
