#include "filasofia/prefab/task.h"

#include "filasofia/core/published.h"
#include "filasofia/core/text.h"
#include "filasofia/core/validate.h"
#include "filasofia/prefab/remember.h"
#include "filasofia/prefab/turns.h"

#include <tuple>

namespace filasofia::prefab {
namespace {

TaskDef checked(TaskDef def)
{
    const std::string object = text("task '", shown(def.name), "'");
    validate(def, object);
    if (def.steps.empty()) fail(object, ": steps must have at least one entry, got none");
    for (std::size_t i = 0; i < def.steps.size(); ++i)
        if (!def.steps[i].done) fail(object, ": steps[", i, "].done must be a function, got an empty one");
    return def;
}

std::string statusOf(const TaskDef& def, int done)
{
    const auto step = static_cast<std::size_t>(done);
    return text(done, " of ", def.steps.size(), def.steps.size() == 1 ? " step done" : " steps done",
                step < def.steps.size() ? text(", next '", shown(def.steps[step].name), "'") : std::string());
}

} // namespace

struct Task::Impl {
    Impl(runtime::Simulation& sim, TaskDef asked) : simulation(sim), def(checked(std::move(asked))) {}

    [[nodiscard]] const TaskStep* next() const
    {
        return progress.step < static_cast<int>(def.steps.size()) ? &def.steps[static_cast<std::size_t>(progress.step)]
                                                                  : nullptr;
    }

    /// Before every step: evaluates the newest state.
    void watch()
    {
        const frame::FrameRef frame = simulation.physics().latest();
        if (!frame) return;
        turns.now([&] {
            if (!began) began = stepBegan = frame->time;
            if (progress.state != TaskProgress::State::Running) return;
            progress.time = frame->time - *began;
            publish(); // because the step may ask for it
            advance(*frame);
            publish();
        });
    }

    void advance(const frame::Frame& frame)
    {
        if (const TaskStep* step = next(); step->done(frame)) {
            if (def.tracker != nullptr) def.tracker->mark(metric::EventKind::Step, step->name);
            progress.doneAt.push_back(progress.time);
            ++progress.step;
            stepBegan = frame.time;
            late = false;
        } else if (!late && frame.time - stepBegan > step->timeLimit) {
            late = true;
            if (def.tracker != nullptr) def.tracker->mark(metric::EventKind::Mistake, text(step->name, ": too slow"));
        }
        const TaskStep* step = next();
        progress.target = step != nullptr && step->target ? step->target(frame) : std::nullopt;
        if (step == nullptr)
            end(true);
        else if (progress.time > def.timeLimit)
            end(false);
    }

    void unfinished(const std::string& why) const
    {
        if (def.tracker != nullptr)
            def.tracker->mark(metric::EventKind::Unfinished, text(why, ": ", statusOf(def, progress.step)));
    }

    void end(bool done)
    {
        if (!done) unfinished(text("out of time after ", def.timeLimit, " s"));
        progress.state = done ? TaskProgress::State::Done : TaskProgress::State::Failed;
        progress.target = {};
        publish();
        if (def.over) def.over(done);
    }

    using Kept = std::tuple<TaskProgress, std::optional<double>, double, bool>;
    auto kept() { return std::tie(progress, began, stepBegan, late); }
    void publish() { newest.write(progress); }

    runtime::Simulation& simulation;
    const TaskDef def;
    Turns turns; // guards the members below
    TaskProgress progress;
    std::optional<double> began;
    double stepBegan = 0.0;
    bool late = false;
    Published<TaskProgress> newest; // for all threads
};

Task::Task(runtime::Simulation& simulation, TaskDef def) : impl_(std::make_shared<Impl>(simulation, std::move(def)))
{
    simulation.everyStep([weak = std::weak_ptr(impl_)](double) {
        if (const auto impl = weak.lock()) impl->watch();
    });
    remember(simulation, text("task '", shown(impl_->def.name), "'"), impl_);
}

TaskProgress Task::progress() const { return impl_->newest.read(); }

const TaskDef& Task::def() const { return impl_->def; }

std::string Task::instruction() const
{
    const auto step = static_cast<std::size_t>(progress().step);
    return step < impl_->def.steps.size() ? impl_->def.steps[step].instruction : std::string();
}

std::string Task::status() const { return statusOf(impl_->def, progress().step); }

void Task::leave() const
{
    impl_->turns.wait([&] {
        if (impl_->progress.state == TaskProgress::State::Running) impl_->unfinished("the run ended");
    });
}

void Task::restart()
{
    impl_->turns.take(!impl_->simulation.physics().stepsHere(), [impl = impl_.get()] {
        impl->progress = {};
        impl->began.reset();
        impl->late = false;
        impl->publish();
    });
}

std::string shown(std::string_view text, std::size_t maxBytes)
{
    if (text.size() <= maxBytes) return oneLine(std::string(text));
    std::size_t end = maxBytes;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0U) == 0x80U) --end; // inside a UTF-8 character
    return oneLine(std::string(text.substr(0, end))) + "\u2026";
}

} // namespace filasofia::prefab
