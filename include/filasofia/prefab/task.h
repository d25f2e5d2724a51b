#pragma once

#include "filasofia/core/fields.h"
#include "filasofia/prefab/metric_tracker.h"
#include "filasofia/runtime/simulation.h"

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace filasofia::prefab {

/// What a trainee has to do next. Names and instructions are typed text of any length, shown as one line.
struct TaskStep {
    std::string name = {};                                      ///< as the session records it
    std::string instruction = {};                               ///< what the trainee reads
    double timeLimit = std::numeric_limits<double>::infinity(); ///< [s], > 0; a step that takes longer is recorded as a
                                                                ///< mistake, and goes on
    /// Whether the step is done. Called for every state while this step is the next, on the stepping thread.
    std::function<bool(const frame::Frame&)> done = {};
    /// [m], where to go, in the world; empty, or no result: no particular place.
    std::function<std::optional<Vec3>(const frame::Frame&)> target = {};
};
constexpr auto fields(const TaskStep*)
{
    using T = TaskStep;
    return describe("TaskStep", field("name", &T::name, "as the session records it"),
                    field("instruction", &T::instruction, "what the trainee reads"),
                    field("timeLimit", &T::timeLimit, "s", positiveOrInfinite(), "exceeding it is a mistake"));
}

struct TaskDef {
    std::string name = "task";
    std::vector<TaskStep> steps = {}; ///< at least one, done in this order
    /// [s], > 0, for the whole task; after it the task has failed.
    double timeLimit = std::numeric_limits<double>::infinity();
    /// Gets a Step for each completed step, a Mistake for each that took too long, and Unfinished if the time is up.
    MetricTracker* tracker = nullptr;
    std::function<void(bool)> over = {}; ///< called once on the stepping thread: whether the task was done
};
constexpr auto fields(const TaskDef*)
{
    using T = TaskDef;
    return describe("TaskDef", field("name", &T::name, "what errors call it"), field("steps", &T::steps, "in order"),
                    field("timeLimit", &T::timeLimit, "s", positiveOrInfinite(), "limit for the whole task"));
}

/// The progress of a task.
struct TaskProgress {
    enum class State { Running, Done, Failed };
    State state = State::Running;
    int step = 0;                    ///< [-], index of the next step; the number of steps if all are done
    double time = 0.0;               ///< [s], simulated, since it began
    std::optional<Vec3> target = {}; ///< [m], target of the next step, in the world
    std::vector<double> doneAt = {}; ///< [s] since the beginning, for each completed step
};

/// Ordered steps, each with its own condition. The task begins with the first step of the simulation that is not
/// paused, and uses simulated time only. A saved state knows how far it is, but not what `done` functions remember
/// (Simulation::remember() is for them).
class Task {
public:
    /// Construct it before a run; throws an Error if the Def is wrong.
    Task(runtime::Simulation& simulation, TaskDef def);

    [[nodiscard]] TaskProgress progress() const; ///< any thread
    [[nodiscard]] const TaskDef& def() const;
    [[nodiscard]] std::string instruction() const; ///< the next step's; empty if there is none
    /// How far it is, in words: "1 of 3 steps done, next 'grasp'".
    [[nodiscard]] std::string status() const;
    /// To be called after a run, before the tracker is closed: a task that is still running gets Unfinished.
    void leave() const;
    void restart(); ///< at the simulation's next step

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // shared with the simulation's callback
};

/// Typed text as it can be shown: one line of at most `maxBytes` bytes, cut between characters, with an ellipsis.
std::string shown(std::string_view text, std::size_t maxBytes = 80);

} // namespace filasofia::prefab
