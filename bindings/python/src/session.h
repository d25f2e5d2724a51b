#pragma once

#include "filasofia/runtime/simulation.h"
#include "filasofia/runtime/stepped_run.h"

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

namespace filasofia::python {

/// An event on its way to Python.
using Arrived = std::variant<runtime::ContactEvent, runtime::CutEvent, runtime::TearEvent, runtime::FileFailedEvent,
                             event::PhysicsUpdateEvent>;

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
    [[nodiscard]] bool usable() const;
    [[nodiscard]] runtime::Simulation& simulation() { return simulation_; }
    [[nodiscard]] physics::PhysicsServer& physics() { return simulation_.physics(); }

    /// While it lives, nobody else steps, draws or closes.
    class Turn {
    public:
        /// Throws an Error if another thread has the turn, or this one (a callback of a step).
        Turn(Session& session, const char* what);
        ~Turn() { session_.busy_.clear(std::memory_order_release); }
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;

    private:
        Session& session_;
    };

    /// What the run of this simulation is asked to write; Error after the first step.
    void record(const runtime::RunDef& def);

    // For the owner of the turn.
    physics::StepReport step();
    visual::Image picture(const runtime::PictureDef& def);
    [[nodiscard]] runtime::RunReport report();
    /// Ends the run; what it was stays readable.
    void close();
    /// Asks whoever makes many steps to stop, because the interpreter ends.
    void askEnd() { endAsked_.store(true); }
    [[nodiscard]] bool endAsked() const { return endAsked_.load(std::memory_order_relaxed); }
    [[nodiscard]] bool closed() const { return closed_.load(); }
    [[nodiscard]] bool stepping() const { return busy_.test(std::memory_order_acquire); }
    [[nodiscard]] std::vector<Arrived> takeArrived() { return std::exchange(arrived_, {}); }
    [[nodiscard]] bool anyArrived() const { return !arrived_.empty(); }

    /// From now on events of this alternative of Arrived are collected.
    void collect(std::size_t alternative);

    /// Called before every step that is not paused, on the thread that steps; the owner of the turn sets it.
    std::function<void(double time)> beforeStep = {};
    [[nodiscard]] double period() const { return period_; } ///< [s]
    [[nodiscard]] double time() const { return time_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::uint64_t steps() const { return steps_.load(std::memory_order_relaxed); }

private:
    explicit Session(const runtime::SimulationDef& def);
    void begin();
    template <class E> void collectAll();

    runtime::Simulation simulation_;
    runtime::RunDef asked_ = {};
    std::optional<runtime::SteppedRun> run_;
    runtime::RunReport final_ = {}; ///< after close()
    std::vector<Arrived> arrived_;
    std::array<std::atomic<bool>, std::variant_size_v<Arrived>> collected_ = {};
    double period_ = 1e-3;                 ///< [s]
    std::atomic<double> time_ = 0.0;       ///< [s]
    std::atomic<std::uint64_t> steps_ = 0; ///< [-]
    std::atomic<bool> closed_ = false, endAsked_ = false;
    std::atomic_flag busy_ = {};
    int forks_ = 0; ///< how often the process had forked when it was made
};

/// Closes every session, at the end of the interpreter: waits for steps that other threads are making.
void closeAll();

} // namespace filasofia::python
