#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/metric/session.h"
#include "filasofia/runtime/simulation.h"

/// Parts of simulators, built on the public interface only.
namespace filasofia::prefab {

/// A body that a MetricTracker observes.
struct TrackedBody {
    BodyId body = {};
    std::string name = {}; ///< empty: the body's own name
    metric::Role role = metric::Role::Tool;
    int element = 0; ///< [-], in [0, 1000000], index in a rigid body
    Vec3 tip = {}; ///< [m], the point that is followed, in the element's coordinates; for a soft body it is the mean of
                   ///< its nodes
    bool force = true;            ///< whether contacts and their forces are recorded too
    Vec3 axis = {0.0, 0.0, -1.0}; ///< [-], direction in which it points, in the element's coordinates
    Vec3 up = {0.0, 1.0, 0.0};    ///< [-], upper side of a scope's picture, in the element's coordinates
};
constexpr auto fields(const TrackedBody*)
{
    using T = TrackedBody;
    return describe("TrackedBody", field("body", &T::body, "the body"),
                    field("name", &T::name, "its name in the session"), field("role", &T::role, "tool, scope or other"),
                    field("element", &T::element, "-", closed(0, 1000000), "index in a rigid body"),
                    field("tip", &T::tip, "m", finite(), "the point that is followed"),
                    field("force", &T::force, "whether contacts are recorded too"),
                    field("axis", &T::axis, "-", finite(), "where it points"),
                    field("up", &T::up, "-", finite(), "the upper side of a scope's picture"));
}

struct MetricTrackerDef {
    std::vector<TrackedBody> bodies = {}; ///< at least one, at most 64
    double rate = 200.0;   ///< [Hz], in [1, 100000], samples per second of simulated time; at most one per step
    double buffer = 4.0;   ///< [s], in [0.1, 600], length of the samples that can wait while the disk takes no data
    std::string file = {}; ///< a .jsonl file (for `filasofia report`) or a .csv file; empty: none
    bool keep = false;     ///< keeps the session in memory too, for session(): 128 bytes per sample
    /// Also gets the lines of the .jsonl file; if it throws an Error, writing ends.
    std::function<void(std::string_view)> write = {};
    /// Trainee, task, date (empty: now), software (empty: Filasofia), limits, targets and steps; `watched` lists the
    /// kinds of events that the simulator marks. The tracker itself adds tracks, tears, cuts, blood,
    /// burns, what electrodes do, and samples.
    metric::Session session = {};
};
constexpr auto fields(const MetricTrackerDef*)
{
    using T = MetricTrackerDef;
    return describe("MetricTrackerDef", field("bodies", &T::bodies, "what is observed"),
                    field("rate", &T::rate, "Hz", closed(1, 100000), "samples per second"),
                    field("buffer", &T::buffer, "s", closed(0.1, 600), "length of the samples that can wait"),
                    field("file", &T::file, "a .jsonl or .csv file"),
                    field("keep", &T::keep, "keep the session in memory too"));
}

/// Observes bodies of a simulation, from its construction to close(), and writes what they did.
///
/// A sample's force is the mean over the steps since the previous sample. Samples are taken on the stepping thread,
/// which costs about a microsecond, and written by the tracker's own thread. In a live run physics never waits for it.
/// A run faster than real time waits for its disk, but not longer than real time would have taken. Memory is bounded:
/// memory() bytes, plus the session if `keep` is set. A sample is lost, and counted, only if writing stalls for longer
/// than `buffer`. If writing fails, that is one line in the log and a FileFailedEvent, and the simulation goes on.
/// While physics is paused nothing is observed. If a saved state is restored, what is later is taken back; if the
/// session does not have what led to the state, it begins with it. That is an Error if `file` is a .csv.
class MetricTracker {
public:
    /// Construct it after the bodies and before a run (Error during one), and destroy it before the simulation. Throws
    /// an Error if the Def is wrong, or if the file cannot be written or something else writes it.
    MetricTracker(runtime::Simulation& simulation, MetricTrackerDef def);
    ~MetricTracker(); ///< calls close()
    MetricTracker(const MetricTracker&) = delete;
    MetricTracker& operator=(const MetricTracker&) = delete;

    /// Throws the Error that the constructor throws if the Def is wrong; writes nothing.
    static void check(runtime::Simulation& simulation, const MetricTrackerDef& def);

    /// Records an event at the present simulated time: a step of the task is done, a wall is pierced. Any thread.
    void mark(metric::EventKind kind, std::string what = {}, std::optional<double> amount = {});

    /// Takes the last state and writes all that waits. Do not call it from inside the simulation's callbacks.
    void close();

    /// The observed session; only after close() and with `keep` (otherwise Error).
    [[nodiscard]] const metric::Session& session() const;

    [[nodiscard]] std::uint64_t taken() const; ///< [-], number of sampled moments
    /// [-], moments that were due but not sampled, and events that did not fit.
    [[nodiscard]] std::uint64_t lost() const;
    [[nodiscard]] bool failed() const; ///< writing ended early
    /// The memory [bytes] of the samples that can wait.
    [[nodiscard]] static std::size_t memory(const MetricTrackerDef& def);

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callbacks, which may outlive this
};

/// The first of "<stem>_1.jsonl", "<stem>_2.jsonl", … that does not exist, so that no session is overwritten.
std::string unusedSessionFile(const std::string& stem);

} // namespace filasofia::prefab
