#pragma once

#include "filasofia/runtime/simulation.h"
#include "filasofia/runtime/stepped_run.h"
#include "filasofia/scene/scene_def.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace filasofia::python {

/// An event on its way to Python.
using Arrived = std::variant<runtime::ContactEvent, runtime::CutEvent, runtime::TearEvent, runtime::IntersectionEvent,
                             runtime::BleedingEvent, runtime::BurnEvent, runtime::EnergyEvent, runtime::DuctEvent,
                             runtime::ClipEvent, runtime::BreakEvent, runtime::DistensionEvent,
                             runtime::FileFailedEvent, event::PhysicsUpdateEvent>;

/// A simulation and its run, shared by the object that Python holds and the frames that Python holds. It knows nothing
/// of Python and never takes the interpreter's lock.
class Session {
public:
    /// A session that fork() has carried into another process is never destroyed there: its threads are not there, and
    /// to join them would be to wait for ever.
    static std::shared_ptr<Session> make(const runtime::SimulationDef& def);

    /// Throws an Error if the process has forked since, or close() was called.
    void requireUsable(const char* what) const;
    /// Whether it would not throw.
    [[nodiscard]] bool usable() const { return !foreign() && !closed(); }
    /// Whether the process has forked since: its threads and locks are those of another one.
    [[nodiscard]] bool foreign() const;
    [[nodiscard]] runtime::Simulation& simulation() { return simulation_; }
    [[nodiscard]] physics::PhysicsServer& physics() { return simulation_.physics(); }

    /// While it lives, nobody else steps, draws or closes.
    class Turn {
    public:
        enum class Of { Open, OpenOrClosed };
        /// Throws an Error if another thread has the turn, or this one (a callback of a step); and if the session is
        /// closed, unless that is no matter.
        Turn(Session& session, const char* what, Of of = Of::Open);
        ~Turn() { session_.busy_.clear(std::memory_order_release); }
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;

    private:
        Session& session_;
    };

    /// Adds a scene before the first step; its measures, and the table of its sensors, are written until close().
    void add(const scene::SceneDef& scene, const prefab::MetricTrackerDef& tracker, const std::string& sensorsFile);
    /// Whether it has begun to run, with a step, a picture or a recording.
    [[nodiscard]] bool begun() const { return run_.has_value(); }
    /// What that scene left to others to draw.
    [[nodiscard]] const std::map<BodyId, runtime::ShownId>& drawn() const { return scene_.drawn; }
    /// That of the scene; null if it has none.
    [[nodiscard]] const prefab::Task* task() const { return scene_.task.get(); }
    /// Those of the scene; null if it has none.
    [[nodiscard]] const prefab::Sensors* sensors() const { return scene_.sensors.get(); }
    /// Begins to measure, before the first step; the file is whole after close().
    void measure(prefab::MetricTrackerDef def);
    /// The part of the simulation lives as long as the session: steps may use it when Python has let it go.
    void keep(std::shared_ptr<void> part) { kept_.push_back(std::move(part)); }
    // For the owner of the turn. The run begins with record(), the first step or the first picture.
    /// Begins the run with what it is to write; Error if it has begun. If it is refused, nothing has happened.
    void record(const runtime::RunDef& def);
    physics::StepReport step();
    visual::Image picture(const runtime::PictureDef& def);
    visual::DepthImage depth(const runtime::PictureDef& def);
    void openViewer(const runtime::ViewerDef& def);
    void showInViewer() { running().showInViewer(); }
    void closeViewer() { running().closeViewer(); }
    /// Error before the first step.
    [[nodiscard]] std::shared_ptr<const runtime::RunState> save();
    void restore(const runtime::RunState& state);
    /// Ends the run; what it was stays readable. Does nothing the second time.
    void close();

    // For the owner of the turn, and for anybody after close().
    /// How the run went until now; all zeros but the hash if it has not begun.
    [[nodiscard]] runtime::RunReport report();
    [[nodiscard]] std::uint64_t hash();
    /// Asks whoever makes many steps to stop, because the interpreter ends.
    void askEnd() { endAsked_.store(true); }
    [[nodiscard]] bool endAsked() const { return endAsked_.load(std::memory_order_relaxed); }
    [[nodiscard]] bool closed() const { return closed_.load(); }
    /// Whether a viewer is open.
    [[nodiscard]] bool viewing() const { return !foreign() && viewed_.load() && run_->viewing(); }
    [[nodiscard]] bool stepping() const { return busy_.test(std::memory_order_acquire); }
    [[nodiscard]] std::vector<Arrived> takeArrived() { return std::exchange(arrived_, {}); }
    [[nodiscard]] bool anyArrived() const { return !arrived_.empty(); }

    /// Notes an event in what is measured; Error if nothing is.
    void mark(metric::EventKind kind, const std::string& what, std::optional<double> amount);
    /// Whether events of this alternative of Arrived are collected, from now on.
    void collect(std::size_t alternative, bool on);

    /// Called before every step that is not paused, on the thread that steps; the owner of the turn sets it.
    std::function<void(double time)> beforeStep = {};
    [[nodiscard]] double period() const { return period_; } ///< [s]
    [[nodiscard]] double time() const { return time_.load(std::memory_order_relaxed); }
    /// Whoever reads this number finds the frame of that step, or a newer one, unless it was not captured.
    [[nodiscard]] std::uint64_t steps() const { return steps_.load(std::memory_order_acquire); }

private:
    explicit Session(const runtime::SimulationDef& def);
    runtime::SteppedRun& running();
    template <class E> void observe(std::size_t alternative);

    /// Whether events of one alternative of Arrived are collected.
    struct Collected {
        std::atomic<bool> observed = false; ///< for ever, from the first time that they were wanted
        std::atomic<bool> wanted = false;
    };

    runtime::Simulation simulation_;
    scene::AddedScene scene_ = {};
    std::mutex trackersMutex_;
    std::vector<std::shared_ptr<prefab::MetricTracker>> trackers_; ///< they end before the simulation
    std::vector<std::shared_ptr<void>> kept_;                      ///< so do these
    std::optional<runtime::SteppedRun> run_;
    runtime::RunReport final_ = {}; ///< written before closed_ is set, and never again
    std::vector<Arrived> arrived_;
    std::array<Collected, std::variant_size_v<Arrived>> collected_ = {};
    double period_ = 1e-3;                 ///< [s]
    std::atomic<double> time_ = 0.0;       ///< [s]
    std::atomic<std::uint64_t> steps_ = 0; ///< [-]
    std::atomic<bool> closed_ = false, endAsked_ = false;
    std::atomic<bool> viewed_ = false; ///< a viewer has been opened, so there is a run
    std::atomic_flag busy_ = {};
    int forks_ = 0; ///< how often the process had forked when it was made
};

/// Makes fork() safe while other threads make sessions; call it once, before the first one.
void watchForks();

/// Closes every session, at the end of the interpreter. It waits for steps that other threads are making, but not for
/// ever: a callback may be blocked. Sessions that are still stepping then are left alone, and standard error says so.
void closeAll();

} // namespace filasofia::python
