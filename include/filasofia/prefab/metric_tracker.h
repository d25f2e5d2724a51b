#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/metric/session.h"
#include "filasofia/runtime/simulation.h"

/// Parts of simulators, made of the public interface only.
namespace filasofia::prefab {

/// A body that a MetricTracker observes.
struct TrackedBody {
    BodyId body = {};
    std::string name = {}; ///< empty: the body's own
    metric::Role role = metric::Role::Tool;
    int element = 0;              ///< [-], in [0, 1000000], of a rigid body
    Vec3 tip = {};                ///< [m], the point that is followed, in the element's coordinates; of a soft
                                  ///< body it is the mean of its nodes
    bool force = true;            ///< contacts and their force too
    Vec3 axis = {0.0, 0.0, -1.0}; ///< [-], where it points, in the element's coordinates
    Vec3 up = {0.0, 1.0, 0.0};    ///< [-], of a scope: the upper side of its picture
};
constexpr auto fields(const TrackedBody*)
{
    using T = TrackedBody;
    return describe("TrackedBody", field("body", &T::body, "which"), field("name", &T::name, "its name in the session"),
                    field("role", &T::role, "tool, scope or other"),
                    field("element", &T::element, "-", closed(0, 1000000), "of a rigid body"),
                    field("tip", &T::tip, "m", finite(), "the point that is followed"),
                    field("force", &T::force, "contacts too"),
                    field("axis", &T::axis, "-", finite(), "where it points"),
                    field("up", &T::up, "-", finite(), "the upper side of a scope's picture"));
}

struct MetricTrackerDef {
    std::vector<TrackedBody> bodies = {}; ///< at least one, 64 at most
    double rate = 200.0;   ///< [Hz], in [1, 100000], samples per second of simulated time; a step gives one at most
    double buffer = 4.0;   ///< [s], in [0.1, 600], of samples that may wait while a disk does not take any
    std::string file = {}; ///< a .jsonl file (for `filasofia report`) or a .csv file; empty: none
    bool keep = false;     ///< in memory as well, for session(): 128 bytes per sample
    std::function<void(std::string_view)> write = {}; ///< takes the lines of the .jsonl file as well; an Error ends it
    /// Trainee, task, date (empty: now), software (empty: Filasofia), limits, targets and steps; `watched` has kinds of
    /// events that the simulator marks. Tracks, tears, cuts and samples are the tracker's.
    metric::Session session = {};
};
constexpr auto fields(const MetricTrackerDef*)
{
    using T = MetricTrackerDef;
    return describe("MetricTrackerDef", field("bodies", &T::bodies, "what is observed"),
                    field("rate", &T::rate, "Hz", closed(1, 100000), "samples per second"),
                    field("buffer", &T::buffer, "s", closed(0.1, 600), "of samples that may wait"),
                    field("file", &T::file, "a .jsonl or .csv file"), field("keep", &T::keep, "in memory as well"));
}

/// Observes bodies of a simulation, from its making to close(), and writes what they did.
///
/// A sample's force is the mean over the steps since the sample before. Samples are taken on the stepping thread, which
/// costs a microsecond or so, and written by a thread of the tracker's own. Physics never waits for it in a live run;
/// one that is faster than real time waits for its disk, but no longer than real time would have taken. Memory is
/// bounded: memory() bytes, and what `keep` keeps. A sample is lost, and counted, only where writing stands still for
/// longer than `buffer`. What cannot be written is one line in the log and a FileFailedEvent; the simulation goes on.
/// While physics is paused nothing is observed.
class MetricTracker {
public:
    /// To be made before a run (Error during one), after the bodies; to be destroyed before the simulation. Throws
    /// Error where the Def is wrong or the file cannot be written.
    MetricTracker(runtime::Simulation& simulation, MetricTrackerDef def);
    ~MetricTracker(); ///< closes
    MetricTracker(const MetricTracker&) = delete;
    MetricTracker& operator=(const MetricTracker&) = delete;

    /// Something happened now, in simulated time: a step of the task is done, a wall is pierced. Any thread.
    void mark(metric::EventKind kind, std::string what = {}, std::optional<double> amount = {});

    /// The end: takes the last state, writes all that waits. Not from inside the simulation's callbacks.
    void close();

    /// What was observed; after close(), and only with `keep` (else Error).
    [[nodiscard]] const metric::Session& session() const;

    [[nodiscard]] std::uint64_t taken() const; ///< [-] moments that were sampled
    [[nodiscard]] std::uint64_t lost() const;  ///< [-] moments that should have been, and events that did not fit
    [[nodiscard]] bool failed() const;         ///< writing has ended early
    /// What the samples that may wait take [bytes].
    [[nodiscard]] static std::size_t memory(const MetricTrackerDef& def);

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // the simulation's callbacks have it too, and may outlive this
};

/// The first of "<stem>_1.jsonl", "<stem>_2.jsonl", … that is not there: nobody's session is written over.
std::string unusedSessionFile(const std::string& stem);

} // namespace filasofia::prefab
