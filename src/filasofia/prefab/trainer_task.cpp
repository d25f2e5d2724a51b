#include "filasofia/prefab/trainer_task.h"

#include "filasofia/core/validate.h"

#include <cstdio>
#include <utility>

namespace filasofia::prefab {
namespace {

MetricTrackerDef observedBy(const Training& training, const TrainerTaskDef& def)
{
    MetricTrackerDef out = def.observed;
    out.file = training.file;
    out.session.trainee = training.trainee;
    out.session.seed = static_cast<std::uint64_t>(training.seed);
    out.session.steps.clear();
    for (const TaskStep& step : def.steps) out.session.steps.push_back(step.name);
    out.session.watched.push_back(metric::EventKind::Unfinished);
    return out;
}

} // namespace

struct TrainerTask::Impl {
    Impl(runtime::Simulation& simulation, const Training& given, TrainerTaskDef asked)
        : training(given), def(std::move(asked)), tracker(simulation, observedBy(given, def)),
          bar(simulation, def.force), session(simulation, given), task(simulation, taskDef()),
          guidance(simulation, task)
    {
        session.guide(guidance, def.guided && given.motion.empty());
        session.records(tracker);
        simulation.dress([this](visual::VisualServer& server) {
            if (def.dress) def.dress(server);
            guidance.dress(server);
            session.dress(server);
        });
    }
    TaskDef taskDef()
    {
        const auto over = [this](bool done) {
            const TaskProgress now = task.progress();
            TrainingResult result{.done = done, .seconds = now.time};
            if (def.score) result.score = def.score(now);
            session.over(
                done ? def.done : "Time is up",
                [&] { return def.results ? def.results(now) : std::vector<ResultLine>(); }, result);
        };
        return {.name = def.observed.session.task,
                .steps = def.steps,
                .timeLimit = def.timeLimit,
                .tracker = &tracker,
                .over = over};
    }

    Training training;
    TrainerTaskDef def;
    MetricTracker tracker;
    ForceBar bar;
    TrainingSession session;
    Task task;
    Guidance guidance;
};

TrainerTask::TrainerTask(runtime::Simulation& simulation, const Training& training, TrainerTaskDef def)
{
    validate(def, "trainer task");
    impl_ = std::make_unique<Impl>(simulation, training, std::move(def));
}
TrainerTask::~TrainerTask() = default;

MetricTracker& TrainerTask::tracker() { return impl_->tracker; }
TaskProgress TrainerTask::progress() const { return impl_->task.progress(); }
const ForceBar& TrainerTask::force() const { return impl_->bar; }
std::function<void()> TrainerTask::picture(const std::string& name) const { return impl_->session.picture(name); }

int TrainerTask::run(int steps, const std::function<std::string()>& said)
{
    Impl& it = *impl_;
    if (const int problem = it.session.run(steps)) return problem;
    it.task.leave();
    it.tracker.close();
    const TaskProgress progress = it.task.progress();
    const bool done = progress.state == TaskProgress::State::Done;
    std::printf("%s: %d of %zu steps in %.1f s; %s, highest total force %.2f N; session%s: %s\n",
                done ? "done" : "not done", progress.step, it.def.steps.size(), progress.time, said().c_str(),
                it.bar.highest(), it.tracker.failed() ? " (incomplete)" : "", it.training.file.c_str());
    if (it.tracker.failed()) return 1;
    return it.training.motion == "expert" && !it.session.cutShort() && !done ? 1 : 0;
}

} // namespace filasofia::prefab
