#include "filasofia/runtime/live_run.h"

#include "filasofia/core/log.h"
#include "filasofia/core/real_time.h"
#include "filasofia/runtime/inspector.h"
#include "filasofia/runtime/key_overlay.h"
#include "filasofia/runtime/physics_loop.h"
#include "filasofia/runtime/run_files.h"
#include "filasofia/runtime/run_keys.h"
#include "filasofia/runtime/stop_signal.h"
#include "filasofia/runtime/video_file.h"
#include "filasofia/runtime/window_scene.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace filasofia::runtime {
namespace {

/// The physics thread. It runs from construction to join(), also if the main thread throws.
class PhysicsThread {
public:
    PhysicsThread(Simulation::Impl& impl, const RunDef& def) : impl_(impl)
    {
        PhysicsLoopDef loop{.period = impl.period(),
                            .slack = toNanoseconds(impl.def.physics.slack),
                            .freeRunning = def.freeRunning,
                            .step = impl.step(),
                            .maxSteps = static_cast<std::uint64_t>(def.steps)};
        if (!def.freeRunning)
            loop.deadline = impl.deadline(); // a free run measures what steps cost, so it has no deadline
        thread_ = std::thread([this, loop] {
            realTime_ = impl_.def.physics.realTime && !loop.freeRunning && requestRealTime();
            timing_ = runPhysics(
                impl_.physics, loop, impl_.clock, impl_.control.stopAsked(),
                [this](const physics::StepReport& step) { return impl_.afterStep(step); },
                [this](double dt) { impl_.beforeStep(dt); });
            impl_.control.finish(text("made ", timing_.stepCount, " steps"));
        });
    }
    ~PhysicsThread() { join(); }

    void join()
    {
        if (!thread_.joinable()) return;
        impl_.control.stop();
        thread_.join();
    }
    void fill(RunReport& report)
    {
        report.timing = std::move(timing_);
        report.realTime = realTime_;
    }

private:
    Simulation::Impl& impl_;
    RunTiming timing_;
    bool realTime_ = false;
    std::thread thread_;
};

/// While it lives, events are delivered on the dispatcher's own thread.
class EventThread {
public:
    explicit EventThread(event::EventDispatcher& events) : events_(events) { events_.start(); }
    ~EventThread()
    {
        try {
            events_.stop();
        } catch (const std::exception& problem) { // observers that answer each other without end
            logError("events: ", problem.what());
        }
    }

private:
    event::EventDispatcher& events_;
};

/// The main thread's loop: input, mapping, picture.
class Screen {
public:
    Screen(Simulation::Impl& impl, const RunDef& def)
        : impl_(impl), scene_(impl, openWindow(impl, impl.def.window, def.backend), impl.def.window, def.backend),
          visual_(&scene_.visual())
    {
        if (!def.video.empty()) video_.emplace(def.video, visual_->width(), visual_->height(), def.fps);
        inspector_ = std::make_unique<Inspector>(impl, *visual_);
        keys_ = std::make_unique<KeyOverlay>(*visual_);
    }

    void input()
    {
        scene_.input([this](std::unique_ptr<event::Event> event) { route(std::move(event)); });
        if (scene_.closed()) impl_.control.finish("window closed");
    }
    /// `wall` [s] is the time since the run's start.
    void draw(double wall)
    {
        impl_.mapNewestFrame(*visual_);
        inspector_->beforePicture();
        bool drawn = true;
        if (video_ && video_->due(wall)) {
            if (!impl_.files.attempt([&] { video_->show(visual_->capture(), wall); })) video_.reset();
        } else {
            drawn = visual_->render();
        }
        impl_.takeScreenshots(*visual_);
        if (drawn) post(std::make_unique<event::VisualUpdateEvent>());
        inspector_->afterPicture(drawn);
    }
    void closeVideo(const std::string& file)
    {
        if (video_ && impl_.files.attempt([this] { video_->close(); })) impl_.files.addPicture(file);
    }
    /// A picture for a file shows the scene without the inspector.
    void closeInspector() { inspector_->setOpen(false); }
    [[nodiscard]] visual::VisualServer& visual() { return *visual_; }

private:
    /// Offers an event to inspector, Guis, haptics, keys and camera in this order; the first that takes it may keep it.
    /// A Gui comes before all others: what it keeps neither acts on the run, nor turns the camera, nor reaches
    /// observers. Observers still hear of events that keys and camera have used.
    void route(std::unique_ptr<event::Event> event)
    {
        // An event for a Gui is for nobody else. Observers hear of all others, including those that keys and camera act
        // on.
        if (inspector_->handle(*event) || visual_->handle(*event)) return;
        if (!impl_.haptics.handle(*event) && !act(*event)) impl_.steering.handle(*event, impl_.bindings);
        post(std::move(event));
    }

    /// Returns whether the event was a key of the run.
    bool act(const event::Event& event)
    {
        const auto* key = dynamic_cast<const event::KeyEvent*>(&event);
        const std::optional<RunAction> action = key && impl_.def.look.keys ? actionOf(*key) : std::nullopt;
        if (!action) return false;
        switch (*action) {
        case RunAction::Pause:
            impl_.setPaused(!impl_.pause.paused());
            break;
        case RunAction::Step:
            impl_.pause.askSingleStep();
            break;
        case RunAction::Reset:
            impl_.reset();
            break;
        case RunAction::Screenshot:
            impl_.screenshots.ask({});
            break;
        case RunAction::Help:
            keys_->toggle();
            break;
        case RunAction::Quit:
            impl_.control.finish("Escape");
            break;
        }
        return true;
    }

    void post(std::unique_ptr<event::Event> event)
    {
        impl_.now.stamp(*event);
        if (!impl_.events.tryPost(std::move(event)) && !std::exchange(warned_, true))
            logWarning("events arrive faster than observers handle them: some are lost");
    }

    Simulation::Impl& impl_;
    WindowScene scene_;
    visual::VisualServer* visual_; ///< the scene's
    std::optional<VideoFile> video_;
    std::unique_ptr<Inspector> inspector_; ///< after the server, whose Gui it is
    std::unique_ptr<KeyOverlay> keys_;
    bool warned_ = false;
};

void loop(Simulation::Impl& impl, const RunDef& def, Screen& screen)
{
    const Nanoseconds start = impl.clock.now(), end = start + toNanoseconds(def.seconds);
    const Nanoseconds period = toNanoseconds(1.0 / impl.def.look.rate);
    for (Nanoseconds next = start; !impl.control.stopAsked().load();) {
        screen.input();
        screen.draw(toSeconds(impl.clock.now() - start));
        impl.haptics.drain();
        if (StopSignal::received()) impl.control.finish("interrupted");
        if (def.seconds > 0.0 && impl.clock.now() >= end) impl.control.finish(text("ran ", def.seconds, " s"));
        next = std::max(next + period, impl.clock.now());
        impl.clock.sleepUntil(next);
    }
}

} // namespace

RunReport runLive(Simulation::Impl& impl, const RunDef& def)
{
    RunReport report;
    Screen screen(impl, def);
    RunFiles files(impl, def);
    {
        const EventThread events(impl.events);
        PhysicsThread physics(impl, def);
        loop(impl, def, screen);
        physics.join();
        physics.fill(report);
    }
    screen.closeInspector();
    if (!def.picture.empty()) impl.takePicture(screen.visual(), def.picture);
    if (impl.screenshots.asked()) { // whoever ended the run may have asked for one
        impl.mapNewestFrame(screen.visual());
        impl.takeScreenshots(screen.visual());
    }
    files.close();
    screen.closeVideo(def.video);
    report.visual = screen.visual().statistics();
    return report;
}

} // namespace filasofia::runtime
