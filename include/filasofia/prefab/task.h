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

/// What a trainee is to do next. Names and instructions are text that somebody typed: of any length, shown as one line.
struct TaskStep {
    std::string name = {};                                      ///< in the session
    std::string instruction = {};                               ///< what the trainee reads
    double timeLimit = std::numeric_limits<double>::infinity(); ///< [s], > 0: it is then a mistake, and goes on
    /// Is it done: asked of every step's state while it is the next, on the stepping thread.
    std::function<bool(const frame::Frame&)> done = {};
    /// [m] where to go, in the world; empty, or none: nowhere in particular.
    std::function<std::optional<Vec3>(const frame::Frame&)> target = {};
};
constexpr auto fields(const TaskStep*)
{
    using T = TaskStep;
    return describe("TaskStep", field("name", &T::name, "in the session"),
                    field("instruction", &T::instruction, "what the trainee reads"),
                    field("timeLimit", &T::timeLimit, "s", positiveOrInfinite(), "beyond it is a mistake"));
}

struct TaskDef {
    std::string name = "task";
    std::vector<TaskStep> steps = {};                           ///< at least one, done in this order
    double timeLimit = std::numeric_limits<double>::infinity(); ///< [s], > 0, for all of it: then it has failed
    MetricTracker* tracker = nullptr;    ///< gets a Step for each that is done, a Mistake for each that took too long
    std::function<void(bool)> over = {}; ///< told once, on the stepping thread: was it done
};
constexpr auto fields(const TaskDef*)
{
    using T = TaskDef;
    return describe("TaskDef", field("name", &T::name, "what errors call it"),
                    field("steps", &T::steps, "in their order"),
                    field("timeLimit", &T::timeLimit, "s", positiveOrInfinite(), "for all of it"));
}

/// Where a task stands.
struct TaskProgress {
    enum class State { Running, Done, Failed };
    State state = State::Running;
    int step = 0;                    ///< [-], the next, or how many there are
    double time = 0.0;               ///< [s], simulated, since it began
    std::optional<Vec3> target = {}; ///< [m], of the next step, in the world
    std::vector<double> doneAt = {}; ///< [s], since it began, of each step that is done
};

/// Ordered steps, each with its own end. It begins with the first step that is not paused, and uses simulated time
/// only.
class Task {
public:
    /// Before a run; throws Error where the Def is wrong.
    Task(runtime::Simulation& simulation, TaskDef def);

    [[nodiscard]] TaskProgress progress() const; ///< any thread
    [[nodiscard]] const TaskDef& def() const;
    [[nodiscard]] std::string instruction() const; ///< of the next step; empty when there is none
    void restart();                                ///< at the next step

private:
    struct Impl;
    std::shared_ptr<Impl> impl_; // the simulation's callback has it too
};

/// A text that somebody typed as it can be shown: one line, `most` bytes at most, cut between letters, with an
/// ellipsis.
std::string shown(std::string_view text, std::size_t most = 80);

} // namespace filasofia::prefab
