#include "filasofia/prefab/metric_tracker.h"

#include "filasofia/core/date.h"
#include "filasofia/core/guarded_call.h"
#include "filasofia/core/log.h"
#include "filasofia/core/mpsc_queue.h"
#include "filasofia/core/spsc_ring.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/core/word.h"
#include "filasofia/metric/sampling.h"
#include "filasofia/prefab/file_failure.h"
#include "filasofia/prefab/session_writer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <filesystem>
#include <limits>
#include <mutex>
#include <thread>

namespace filasofia::prefab {
namespace {

using metric::Event;
using metric::EventKind;
using metric::Sample;

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxBodies = 64;
constexpr int kMaxEvents = 100'000;     ///< [-], events that can wait
constexpr std::size_t kChunk = 1 << 16; ///< [bytes] written at once
constexpr double kNothing = -1.0;       ///< [s], before the first sample
constexpr std::chrono::milliseconds kRest = std::chrono::milliseconds(20);
constexpr std::chrono::microseconds kRoomPoll = std::chrono::microseconds(100); ///< between two checks for room

std::string nameOf(runtime::Simulation& simulation, BodyId body)
{
    return std::visit([](const auto& def) { return def.name; }, *simulation.physics().def(body));
}

void checkNumbers(const MetricTrackerDef& def)
{
    validate(def, "metric tracker");
    if (def.bodies.empty() || def.bodies.size() > kMaxBodies)
        fail("metric tracker: bodies must be in [1, ", kMaxBodies, "], got ", def.bodies.size());
    for (std::size_t i = 0; i < def.bodies.size(); ++i) {
        const TrackedBody& body = def.bodies[i];
        for (const auto& [vector, field] : {std::pair{body.axis, "axis"}, {body.up, "up"}})
            if (length(vector) == 0.0)
                fail("metric tracker: bodies[", i, "].", field, " must have a length > 0, got 0 0 0");
    }
    const auto positive = [](const std::optional<double>& value, const char* field) {
        if (value && !(*value > 0.0)) fail("metric tracker: session.", field, " must be > 0, got ", *value);
    };
    positive(def.session.idealPath, "idealPath");
    positive(def.session.forceLimit, "forceLimit");
    positive(def.session.fieldOfView, "fieldOfView");
}

/// Checks what would silently be missing from the session's measures: an element that no body has, a target that does
/// not exist.
void checkBodies(runtime::Simulation& simulation, const MetricTrackerDef& def)
{
    for (std::size_t i = 0; i < def.bodies.size(); ++i) {
        const auto asked = simulation.physics().def(def.bodies[i].body);
        const auto* rigid = std::get_if<physics::RigidBodyDef>(asked.get());
        const std::size_t elements = rigid ? rigid->elements.size() + rigid->articulation.joints.size() : 1;
        if (static_cast<std::size_t>(def.bodies[i].element) >= elements)
            fail("metric tracker: bodies[", i, "].element must be < ", elements, " (elements of '",
                 nameOf(simulation, def.bodies[i].body), "'), got ", def.bodies[i].element);
    }
    const std::vector<BodyId> bodies = simulation.physics().bodies();
    for (const std::string& target : def.session.targets)
        if (std::ranges::none_of(bodies, [&](BodyId body) { return nameOf(simulation, body) == target; }))
            logWarning("metric tracker: session.targets: no body has the name ", shownWord(target), " now");
}

/// The session before its first sample.
metric::Session begun(runtime::Simulation& simulation, const MetricTrackerDef& def)
{
    metric::Session session = def.session;
    session.tracks.clear();
    session.events.clear();
    session.lost = 0;
    session.complete = true;
    if (session.date.empty()) session.date = dateNow();
    if (session.software.empty()) session.software = "Filasofia " FILASOFIA_VERSION;
    for (const EventKind kind :
         {EventKind::Tear, EventKind::Cut, EventKind::Clip, EventKind::ClipLost, EventKind::ClipSlipped})
        if (std::find(session.watched.begin(), session.watched.end(), kind) == session.watched.end())
            session.watched.push_back(kind);
    for (const TrackedBody& body : def.bodies)
        session.tracks.push_back({.name = body.name.empty() ? nameOf(simulation, body.body) : body.name,
                                  .role = body.role,
                                  .force = body.force,
                                  .axis = body.axis,
                                  .up = body.up});
    return session;
}

std::size_t rowsOf(const MetricTrackerDef& def)
{
    return static_cast<std::size_t>(std::ceil(def.buffer * def.rate)) + 1;
}

} // namespace

struct MetricTracker::Impl {
    using Row = std::vector<Sample>; ///< the samples of one moment, one per body

    /// What was observed until the last step.
    struct Observation {
        std::vector<metric::StepSampler> samplers; ///< one per body
        std::optional<double> stepEnd;             ///< [s], end of the last step that began
        std::optional<double> seen;                ///< [s], time of the newest frame that was seen
        double lastPeriod = kNothing;
    };
    struct Token {}; ///< says which tracker it was
    /// What a saved state has of a tracker.
    struct Past {
        Observation observed;
        std::shared_ptr<const Token> tracker;
        std::uint64_t number = 0; ///< [-], counts the saved states of the tracker
        double time = 0.0;        ///< [s], when it was saved
    };
    /// A return to a state: those that were saved before and are later are no longer in the session.
    struct Return {
        std::uint64_t saved = 0; ///< [-], number of saved states then
        double time = 0.0;       ///< [s], to which it led
    };

    Impl(runtime::Simulation& sim, MetricTrackerDef asked)
        : simulation(sim), def(std::move(asked)), session(begun(sim, def)), rows(rowsOf(def)),
          writer(def.file, def.write)
    {
        observed.samplers = newSamplers();
        writer.head(session);
        thread = std::thread([this] { run(); });
    }
    ~Impl() { end(); }

    /// One per body.
    [[nodiscard]] std::vector<metric::StepSampler> newSamplers() const
    {
        std::vector<metric::StepSampler> made;
        for (const TrackedBody& body : def.bodies)
            made.emplace_back(
                metric::Observed{.body = body.body, .element = body.element, .tip = body.tip, .force = body.force});
        return made;
    }

    // Stepping thread.

    /// Before a step that will end at `time`. The newest frame is that of the step before, unless readers hold all
    /// frames.
    void observe(double time)
    {
        const std::unique_lock lock(sampling, std::try_to_lock);
        if (!lock || closed) return;
        take();
        observed.stepEnd = time;
    }

    /// Samples the newest state if a sample is due. Called with the lock.
    void take()
    {
        const frame::FrameRef frame = simulation.physics().latest();
        auto& [samplers, stepEnd, seen, lastPeriod] = observed;
        if (stepEnd && (!frame || frame->time < *stepEnd) && due(*stepEnd))
            lost.fetch_add(1, std::memory_order_relaxed);
        if (!frame || (seen && frame->time <= *seen)) return;
        for (metric::StepSampler& sampler : samplers) sampler.add(*frame, seen ? frame->time - *seen : 0.0);
        seen = frame->time;
        if (!due(frame->time)) return;
        if (!begin) begin = {Clock::now(), frame->time};
        Row* row = rows.beginWrite();
        if (!row) row = waitForRoom(frame->time);
        if (!row) {
            lost.fetch_add(1, std::memory_order_relaxed);
            return;
        }
        row->resize(samplers.size());
        for (std::size_t i = 0; i < samplers.size(); ++i) (*row)[i] = samplers[i].take();
        rows.publish();
        taken.fetch_add(1, std::memory_order_relaxed);
    }

    /// Waits for room, because a run faster than real time may outrun any disk. It never waits so long that the run
    /// falls behind real time: in a live run, not at all.
    Row* waitForRoom(double time)
    {
        const std::chrono::duration<double> wall = Clock::now() - begin->wall;
        const std::chrono::duration<double> ahead(time - begin->simulated - wall.count());
        Row* row = nullptr;
        const auto until = Clock::now() + ahead;
        hurry.store(true, std::memory_order_relaxed);
        while ((row = rows.beginWrite()) == nullptr && Clock::now() < until) {
            wake.notify_all(); // without the lock, so it may be missed: the next one wakes
            std::this_thread::sleep_for(kRoomPoll);
        }
        return row;
    }

    /// Whether a sample is due at this time [s]. The next one is due in the next period of the rate.
    bool due(double time)
    {
        const double period = std::floor(time * def.rate + 1e-6);
        if (period <= observed.lastPeriod) return false;
        observed.lastPeriod = period;
        return true;
    }

    // Stepping thread, between two steps: saved states.

    std::any save()
    {
        const std::lock_guard lock(sampling);
        if (closed) return {};
        take(); // so the session has what leads to the state, and nothing of it waits
        const frame::FrameRef frame = simulation.physics().latest();
        return Past{observed, token, ++saved, frame ? frame->time : 0.0};
    }
    /// Error if the session cannot be taken back.
    void checkBack() const
    {
        if (!writer.goesBack())
            fail("restore: the session is written to '", shortened(def.file), "', where time only goes on");
    }
    /// The session goes on from the state. It begins there if it does not have what led to it: if the state is one of
    /// another tracker, or one that was taken back.
    void goBack(const Past* past)
    {
        const std::lock_guard lock(sampling);
        if (closed) return;
        const bool known = past && past->tracker == token && std::ranges::none_of(returns, [&](const Return& each) {
                               return each.saved >= past->number && each.time < past->time;
                           });
        const double time = known ? past->time : kNothing;
        observed = known ? past->observed : Observation{newSamplers(), {}, {}, kNothing};
        begin.reset();
        std::erase_if(returns, [time](const Return& each) { return each.time >= time; });
        returns.push_back({saved, time});
        const std::lock_guard writing(draining);
        drain(true);
        attempt([&] {
            writer.back(time);
            writer.flush();
        });
        if (def.keep) metric::takeBack(session, time);
    }

    // Any thread.

    void add(Event event)
    {
        if (waiting.fetch_add(1, std::memory_order_relaxed) >= kMaxEvents) {
            waiting.fetch_sub(1, std::memory_order_relaxed);
            lost.fetch_add(1, std::memory_order_relaxed);
            return;
        }
        events.push(std::move(event));
    }

    void end()
    {
        {
            const std::lock_guard lock(sampling);
            if (!std::exchange(closed, true)) take();
        }
        for (const event::ObserverId id : observers) simulation.events().detach(id);
        observers.clear();
        {
            const std::lock_guard lock(resting);
            stopping = true;
        }
        wake.notify_all();
        if (thread.joinable()) thread.join();
    }

    // Writing thread, or the stepping one if it goes back. The writing thread is not woken for each sample, because
    // that would be a system call on the stepping thread.

    void run()
    {
        for (bool last = false; !last;) {
            {
                std::unique_lock lock(resting);
                wake.wait_for(lock, kRest, [this] { return stopping || hurry.load(std::memory_order_relaxed); });
                last = stopping;
                hurry.store(false, std::memory_order_relaxed);
            }
            const std::lock_guard writing(draining);
            drain(last);
        }
        session.lost = lost.load();
        attempt([this] {
            writer.end(session.lost);
            writer.close();
        });
    }

    /// Takes what has happened, ordered by time.
    void takeEvents()
    {
        while (std::optional<Event> event = events.pop()) {
            waiting.fetch_sub(1, std::memory_order_relaxed);
            const auto later = std::ranges::upper_bound(happened, event->time, {}, &Event::time);
            happened.insert(later, std::move(*event));
        }
    }
    /// Writes the events up to this time [s].
    void writeEvents(double time)
    {
        const auto end = std::ranges::upper_bound(happened, time, {}, &Event::time);
        for (auto event = happened.begin(); event != end; ++event) {
            attempt([&] { writer.event(session, *event); });
            if (def.keep) keep(std::move(*event));
        }
        happened.erase(happened.begin(), end);
    }

    /// Writes samples and events, by time. With `last` nothing waits any more. Called with the lock `draining`.
    void drain(bool last)
    {
        takeEvents();
        // At most one buffer's worth: whoever waits for room must not wait as long as new samples keep coming.
        const std::size_t limit = rowsOf(def);
        std::size_t count = 0;
        Row* row = nullptr;
        for (; count < limit && (row = rows.beginRead()); ++count, rows.release()) {
            takeEvents(); // those before a sample have been queued before it: lines ascend in time
            writeEvents(row->front().time);
            attempt([&] {
                writer.samples(session, *row);
                if (writer.gathered() > kChunk) writer.flush();
            });
            if (def.keep)
                for (std::size_t i = 0; i < row->size(); ++i) session.tracks[i].samples.push_back((*row)[i]);
        }
        if (count == 0 || last) writeEvents(std::numeric_limits<double>::infinity());
        attempt([this] { writer.flush(); });
    }

    void keep(Event event)
    {
        const auto later = std::upper_bound(session.events.begin(), session.events.end(), event.time,
                                            [](double time, const Event& each) { return time < each.time; });
        session.events.insert(later, std::move(event));
    }

    /// After a failure nothing more is written.
    void attempt(const std::function<void()>& write)
    {
        if (failed.load()) return;
        const std::optional<std::string> problem = guardedCall(write);
        if (!problem) return;
        failed.store(true);
        tellFileFailure(simulation, text("metric tracker: ", *problem, "; the session goes on without recording"));
    }

    runtime::Simulation& simulation;
    const MetricTrackerDef def;
    metric::Session session;
    SpscRing<Row> rows;
    MpscQueue<Event> events;
    std::vector<Event> happened;  ///< taken and not written, by time; with the lock `draining`
    std::atomic<int> waiting = 0; ///< [-], events
    std::atomic<std::uint64_t> taken = 0, lost = 0;
    std::atomic<bool> failed = false;
    SessionWriter writer;
    std::vector<event::ObserverId> observers;

    std::mutex sampling; ///< held while sampling: by the stepping thread, which never waits for it, or by end()
    bool closed = false;
    Observation observed;
    const std::shared_ptr<const Token> token = std::make_shared<const Token>();
    std::vector<Return> returns;
    std::uint64_t saved = 0; ///< [-], states

    struct Begin {
        Clock::time_point wall;
        double simulated; ///< [s]
    };
    std::optional<Begin> begin; ///< time of the first sample

    std::mutex draining; ///< held by who empties the queues and writes
    std::mutex resting;
    std::condition_variable wake;
    bool stopping = false;
    std::atomic<bool> hurry = false; ///< whether the stepping thread waits for room
    std::thread thread;              // last, because it uses all members above
};

MetricTracker::MetricTracker(runtime::Simulation& simulation, MetricTrackerDef def)
{
    check(simulation, def);
    impl_ = std::make_shared<Impl>(simulation, std::move(def));
    const std::weak_ptr<Impl> weak = impl_;
    simulation.everyStep([weak](double time) {
        if (const auto impl = weak.lock()) impl->observe(time);
    });
    simulation.remember({.of = "metric tracker",
                         .save =
                             [weak] {
                                 const auto impl = weak.lock();
                                 return impl ? impl->save() : std::any();
                             },
                         .restore =
                             [weak](const std::any& copy) {
                                 if (const auto impl = weak.lock()) impl->goBack(std::any_cast<Impl::Past>(&copy));
                             },
                         .check =
                             [weak](const std::any&) {
                                 if (const auto impl = weak.lock()) impl->checkBack();
                             }});
    const auto happened = [weak, &simulation](EventKind kind, double time, BodyId body, std::optional<double> amount,
                                              const std::string& which) {
        const auto impl = weak.lock();
        if (!impl) return;
        std::string what;
        try {
            what = nameOf(simulation, body);
        } catch (const Error&) { // removed meanwhile
        }
        impl->add({time, kind, what + which, amount});
    };
    const auto opened = [happened](EventKind kind, const auto& event) {
        happened(kind, event.time, event.rupture.body, event.rupture.area, {});
    };
    impl_->observers = {
        simulation.on<runtime::TearEvent>([opened](const runtime::TearEvent& tear) { opened(EventKind::Tear, tear); }),
        simulation.on<runtime::CutEvent>([opened](const runtime::CutEvent& cut) { opened(EventKind::Cut, cut); }),
        simulation.on<runtime::BleedingEvent>([happened](const runtime::BleedingEvent& blood) {
            happened(EventKind::Blood, blood.time, blood.body, blood.balance.welled, {});
        }),
        simulation.on<runtime::BurnEvent>([happened](const runtime::BurnEvent& burn) {
            if (!burn.target) happened(EventKind::Burn, burn.time, burn.body, burn.balance.burnt, {});
        }),
        simulation.on<runtime::DuctEvent>([happened](const runtime::DuctEvent& duct) {
            const std::string which = duct.duct == 0 ? "" : text(", duct ", duct.duct);
            happened(EventKind::Leak, duct.time, duct.body, duct.balance.lost, which);
        }),
        simulation.on<runtime::DistensionEvent>([weak](const runtime::DistensionEvent& fluid) {
            if (const auto impl = weak.lock())
                impl->add({fluid.time, EventKind::Deficit, "fluid", surface::deficit(fluid.balance)});
        }),
        simulation.on<runtime::ClipEvent>([happened](const runtime::ClipEvent& clip) {
            using enum physics::ClipChange::Kind;
            const auto kind = clip.change.kind;
            happened(kind == Applied  ? EventKind::Clip
                     : kind == Missed ? EventKind::ClipLost
                                      : EventKind::ClipSlipped,
                     clip.time, clip.change.tissue, {}, {});
        }),
        simulation.on<runtime::EnergyEvent>([happened](const runtime::EnergyEvent& energy) {
            const std::string which = energy.electrode == 0 ? "" : text(", electrode ", energy.electrode);
            happened(EventKind::Activation, energy.time, energy.body, energy.balance.active, which);
            happened(EventKind::InAir, energy.time, energy.body, energy.balance.inAir, which);
            happened(EventKind::Energy, energy.time, energy.body, energy.balance.delivered, which);
        })};
}

MetricTracker::~MetricTracker() { close(); }

void MetricTracker::check(runtime::Simulation& simulation, const MetricTrackerDef& def)
{
    checkNumbers(def);
    checkBodies(simulation, def);
}

void MetricTracker::mark(EventKind kind, std::string what, std::optional<double> amount)
{
    const std::vector<std::string>& steps = impl_->def.session.steps;
    if (kind == EventKind::Step && !steps.empty() && std::ranges::find(steps, what) == steps.end())
        logWarning("metric tracker: mark: the session has no step ", shownWord(what));
    const frame::FrameRef frame = impl_->simulation.physics().latest();
    impl_->add({frame ? frame->time : 0.0, kind, std::move(what), amount});
}

void MetricTracker::close() { impl_->end(); }

const metric::Session& MetricTracker::session() const
{
    if (!impl_->def.keep) fail("metric tracker: session() needs keep");
    if (impl_->thread.joinable()) fail("metric tracker: session() must be called after close()");
    return impl_->session;
}

std::uint64_t MetricTracker::taken() const { return impl_->taken.load(); }
std::uint64_t MetricTracker::lost() const { return impl_->lost.load(); }
bool MetricTracker::failed() const { return impl_->failed.load(); }

std::size_t MetricTracker::memory(const MetricTrackerDef& def)
{
    return rowsOf(def) * (sizeof(Impl::Row) + def.bodies.size() * sizeof(Sample));
}

std::string unusedSessionFile(const std::string& stem)
{
    for (int number = 1;; ++number)
        if (std::string file = text(stem, "_", number, ".jsonl"); !std::filesystem::exists(file)) return file;
}

} // namespace filasofia::prefab
