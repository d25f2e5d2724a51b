#include "filasofia/runtime/stepped_run.h"

#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/core/word.h"
#include "filasofia/runtime/check_file.h"
#include "filasofia/runtime/picture_thread.h"
#include "filasofia/runtime/run_files.h"

namespace filasofia::runtime {
namespace {

RunDef checked(RunDef def)
{
    validate(def, "stepped run");
    checkFile("stepped run", def.log, "log", ".csv");
    checkFile("stepped run", def.record, "record", ".rec");
    checkFile("stepped run", def.recordMotion, "recordMotion", ".csv");
    if (def.steps != 0 || def.seconds != 0.0) fail("stepped run: steps and seconds must be 0: its owner ends it");
    if (!def.picture.empty() || !def.video.empty() || def.pictureEvery != 0.0)
        fail("stepped run: picture, pictureEvery and video are for other runs: ask for each picture");
    if (def.freeRunning) fail("stepped run: freeRunning is for live runs");
    def.headless = true; // what the haptic interfaces ask
    return def;
}

/// While it lives, a step is made: what is called in it cannot be changed.
class Moving {
public:
    explicit Moving(RunControl& control) : control_(control) { control_.rest(false); }
    ~Moving() { control_.rest(true); }
    Moving(const Moving&) = delete;
    Moving& operator=(const Moving&) = delete;

private:
    RunControl& control_;
};

} // namespace

struct SteppedRun::Impl {
    Simulation::Impl& simulation;
    RunDef def;
    RunTiming timing = {};
    std::uint32_t flags = 0; ///< StepFlag bits for the next step's report
    std::optional<RunFiles> files;
    std::atomic<bool> viewing = false; ///< a viewer is open
    std::optional<PictureThread> pictures;
    bool ended = false;

    Impl(Simulation::Impl& itsSimulation, const RunDef& itsDef) : simulation(itsSimulation), def(checked(itsDef)) {}

    void begin();
    void requireRunning(const char* what) const
    {
        if (ended) fail(what, ": the run has ended");
    }
    /// The renderer, from the first picture on.
    template <class Def> PictureThread& drawing(const Def& asked, const char* what);
    [[nodiscard]] RunReport report() const;
};

void SteppedRun::Impl::begin()
{
    if (!simulation.control.begin()) fail("simulation: a run is going on; the next one cannot start before it ends");
    try {
        simulation.beginRun();
        if (simulation.counters.stepsEver() > 0 && !def.record.empty())
            fail("stepped run: record is for a simulation's first run, but this one has already made ",
                 simulation.counters.stepsEver(), " steps");
        simulation.haptics.begin(def, simulation.def.physics, simulation.clock,
                                 [this](std::unique_ptr<DeviceEvent> event) {
                                     simulation.now.stamp(*event);
                                     static_cast<void>(simulation.events.tryPost(std::move(event)));
                                 });
        files.emplace(simulation, def);
        simulation.control.rest(true);
    } catch (...) {
        simulation.haptics.abandon();
        simulation.endRun();
        throw;
    }
}

RunReport SteppedRun::Impl::report() const
{
    RunReport out;
    out.timing = timing;
    simulation.fill(out);
    if (out.finished.empty()) out.finished = "not yet";
    return out;
}

template <class Def> PictureThread& SteppedRun::Impl::drawing(const Def& asked, const char* what)
{
    requireRunning(what);
    validate(asked, what);
    if (!pictures) pictures.emplace(simulation, viewing);
    return *pictures;
}

SteppedRun::SteppedRun(Simulation& simulation, const RunDef& def)
    : impl_(std::make_unique<Impl>(*simulation.impl_, def))
{
    impl_->begin();
}

SteppedRun::~SteppedRun()
{
    if (impl_->ended) return;
    try {
        end();
    } catch (const std::exception& problem) {
        logError("stepped run: ", problem.what());
    }
}

physics::StepReport SteppedRun::step()
{
    impl_->requireRunning("step");
    Simulation::Impl& simulation = impl_->simulation;
    const physics::PhysicsServer::Stepping stepping(simulation.physics);
    const Moving moving(simulation.control);
    const Nanoseconds start = simulation.clock.now();
    const double dt = simulation.step();
    simulation.beforeStep(dt);
    const physics::StepReport report = simulation.physics.step(dt, impl_->flags, {.now = simulation.clock.now});
    impl_->flags = simulation.afterStep(report);
    // Before the next step begins, so that observers' commands reach the same step in every run.
    simulation.events.deliverAll();
    impl_->files->keepUp();
    simulation.haptics.drain();
    ++impl_->timing.stepCount;
    impl_->timing.simulatedSeconds += report.dt;
    impl_->timing.wallSeconds += toSeconds(simulation.clock.now() - start);
    return report;
}

visual::Image SteppedRun::picture(const PictureDef& def) { return impl_->drawing(def, "picture").draw(def); }

visual::DepthImage SteppedRun::depth(const PictureDef& def) { return impl_->drawing(def, "depth").drawDepth(def); }

void SteppedRun::openViewer(const ViewerDef& def) { impl_->drawing(def, "viewer").openViewer(def); }

void SteppedRun::showInViewer()
{
    impl_->requireRunning("viewer");
    if (viewing()) impl_->pictures->showInViewer();
}

void SteppedRun::closeViewer()
{
    if (viewing()) impl_->pictures->closeViewer();
}

bool SteppedRun::viewing() const { return impl_->viewing.load(); }

std::shared_ptr<const RunState> SteppedRun::save()
{
    impl_->requireRunning("save");
    const physics::PhysicsServer::Stepping stepping(impl_->simulation.physics);
    Simulation::Impl& simulation = impl_->simulation;
    return std::make_shared<const RunState>(
        RunState{simulation.physics.save(), simulation.memories.save(), simulation.control.reason()});
}

void SteppedRun::restore(const RunState& state)
{
    impl_->requireRunning("restore");
    for (const std::string* file : {&impl_->def.log, &impl_->def.record})
        if (!file->empty()) fail("restore: the run is written to '", shortened(*file), "', where time only goes on");
    Simulation::Impl& simulation = impl_->simulation;
    if (!simulation.haptics.ids().empty())
        fail("restore: the simulation has a haptic interface, and a hand does not go back");
    const physics::PhysicsServer::Stepping stepping(simulation.physics);
    simulation.memories.check(state.memories);
    simulation.physics.restore(*state.physics);
    const frame::FrameRef now = simulation.physics.latest();
    simulation.now.set(now->time, now->step);
    simulation.memories.restore(state.memories);
    simulation.control.goBack(state.reason);
}

RunReport SteppedRun::report() const { return impl_->report(); }

RunReport SteppedRun::end()
{
    impl_->requireRunning("end");
    impl_->ended = true;
    Simulation::Impl& simulation = impl_->simulation;
    impl_->pictures.reset();
    impl_->files.reset(); // after the last picture: the files record how it was taken
    const std::uint64_t steps = impl_->timing.stepCount;
    simulation.control.finish(text("made ", steps, steps == 1 ? " step" : " steps"));
    try {
        simulation.haptics.end();
    } catch (...) {
        simulation.endRun();
        throw;
    }
    RunReport report = impl_->report();
    simulation.endRun();
    return report;
}

} // namespace filasofia::runtime
