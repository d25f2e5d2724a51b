#pragma once

#include "filasofia/prefab/overlays.h"
#include "filasofia/prefab/task.h"
#include "filasofia/prefab/trainer.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace filasofia::prefab {

/// What a session of a trainer consists of, besides its bodies and hands.
struct TrainerTaskDef {
    std::vector<TaskStep> steps = {}; ///< at least one
    double timeLimit = 300.0;         ///< [s], > 0, for the whole task
    bool guided = false;              ///< a person reads instructions from the start
    /// What is recorded. Trainee, seed, file and steps are those of the training and of the task.
    MetricTrackerDef observed = {};
    ForceBarDef force = {};
    std::string done = "Done";                                                ///< what the end screen says
    std::function<void(visual::VisualServer&)> dress = {};                    ///< adds camera and light
    std::function<std::vector<ResultLine>(const TaskProgress&)> results = {}; ///< for the end screen
    /// [-], the higher the better, for the trainee's learning curve; empty: the time of the task counts.
    std::function<double(const TaskProgress&)> score = {};
};
constexpr auto fields(const TrainerTaskDef*)
{
    using T = TrainerTaskDef;
    return describe("TrainerTaskDef", field("steps", &T::steps, "in order"),
                    field("timeLimit", &T::timeLimit, "s", positive(), "limit for the whole task"),
                    field("guided", &T::guided, "instructions from the start"),
                    field("observed", &T::observed, "what is recorded"), field("force", &T::force, "the bar of force"),
                    field("done", &T::done, "what the end screen says"));
}

/// One session of a trainer as a whole: task, recorded measures, bar of force, guidance, end screen, and the line that
/// the program ends with. Bodies, instruments and hands are the program's own.
class TrainerTask {
public:
    /// Construct it before a run, when bodies and instruments are there. Throws an Error if the Def is wrong.
    TrainerTask(runtime::Simulation& simulation, const Training& training, TrainerTaskDef def);
    ~TrainerTask();
    TrainerTask(const TrainerTask&) = delete;
    TrainerTask& operator=(const TrainerTask&) = delete;

    MetricTracker& tracker();
    [[nodiscard]] TaskProgress progress() const; ///< any thread
    [[nodiscard]] const ForceBar& force() const; ///< any thread
    /// For a move of a planned motion: writes a picture of this name; empty if no pictures are wanted.
    [[nodiscard]] std::function<void()> picture(const std::string& name) const;
    /// Runs for so many steps or, if that is 0, until the person ends it; then says in one line how it went, with what
    /// `said` adds. Returns the exit code: 1 if the expert did not do the task, or the session's file is incomplete.
    int run(int steps, const std::function<std::string()>& said);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace filasofia::prefab
