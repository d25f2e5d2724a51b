#include "filasofia/runtime/parts.h"

#include "filasofia/core/log.h"
#include "filasofia/core/real_time.h"
#include "filasofia/runtime/inspector.h"
#include "filasofia/runtime/key_overlay.h"
#include "filasofia/runtime/physics_loop.h"
#include "filasofia/runtime/run_files.h"
#include "filasofia/runtime/run_keys.h"
#include "filasofia/runtime/stop_signal.h"
#include "filasofia/runtime/video_file.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace filasofia::runtime {
namespace {

/// The physics thread: it runs from construction to join(), also when the main thread throws.
class PhysicsThread {
public:
    PhysicsThread(Simulation::Impl& parts, const RunDef& def) : parts_(parts)
    {
        PhysicsLoopDef loop{.period = parts.period(),
                            .slack = toNanoseconds(parts.def.physics.slack),
                            .freeRunning = def.freeRunning,
                            .maximumSteps = static_cast<std::uint64_t>(def.steps)};
        if (!def.freeRunning) loop.deadline = parts.deadline(); // else it measures what steps cost
        thread_ = std::thread([this, loop] {
            realTime_ = parts_.def.physics.realTime && !loop.freeRunning && requestRealTime();
            timing_ = runPhysics(
                parts_.physics, loop, parts_.clock, parts_.stop,
                [this](const physics::StepReport& step) { return parts_.afterStep(step); },
                [this](double dt) { parts_.beforeStep(dt); });
            parts_.finish(text("made ", timing_.stepCount, " steps"));
        });
    }
    ~PhysicsThread() { join(); }

    void join()
    {
        if (!thread_.joinable()) return;
        parts_.stop.store(true);
        thread_.join();
    }
    void fill(RunReport& report)
    {
        report.timing = std::move(timing_);
        report.realTime = realTime_;
    }

private:
    Simulation::Impl& parts_;
    RunTiming timing_;
    bool realTime_ = false;
    std::thread thread_;
};

/// Delivers events on the dispatcher's own thread while it lives.
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

constexpr int kLargestPicture = 8192; // [px], what a visual server takes

/// The main thread's loop: input, mapping, picture.
class Screen {
public:
    Screen(Simulation::Impl& parts, const RunDef& def) : parts_(parts)
    {
        if (parts.openWindow) {
            window_ = parts.openWindow(parts.def.window);
        } else if (def.backend == visual::Backend::Window) {
            window_ = window::openWindow(parts.def.window);
        }
        size_ = window_ ? window_->size() : window::WindowSize{parts.def.window.width, parts.def.window.height};
        visual_ = std::make_unique<visual::VisualServer>(
            visual::VisualServerDef{.backend = def.backend,
                                    .width = size_.width,
                                    .height = size_.height,
                                    .nativeWindow = window_ ? window_->nativeWindow() : nullptr});
        if (!def.video.empty()) video_.emplace(def.video, visual_->width(), visual_->height(), def.fps);
        if (window_) visual_->setGuiScale(window_->scale());
        parts.bindings.addPending(*visual_);
        parts.dressScene(*visual_);
        inspector_ = std::make_unique<Inspector>(parts, *visual_);
        keys_ = std::make_unique<KeyOverlay>(*visual_);
    }

    void input()
    {
        if (!window_) return;
        window_->poll([this](std::unique_ptr<event::Event> event) { route(std::move(event)); });
        window_->setTextInput(visual_->wantsText());
        if (window_->shouldClose()) parts_.finish("window closed");
        if (const window::WindowSize now = window_->size(); now != size_) {
            size_ = now;
            visual_->resize(std::clamp(now.width, 1, kLargestPicture), std::clamp(now.height, 1, kLargestPicture));
        }
    }
    /// `wall` [s] since the run's start.
    void draw(double wall)
    {
        parts_.mapNewestFrame(*visual_);
        inspector_->beforePicture();
        bool drawn = true;
        if (video_ && video_->due(wall))
            video_->show(visual_->capture(), wall);
        else
            drawn = visual_->render();
        parts_.takeScreenshots(*visual_);
        if (drawn) post(std::make_unique<event::VisualUpdateEvent>());
        inspector_->afterPicture(drawn);
    }
    void closeVideo()
    {
        if (video_) video_->close();
    }
    /// A picture for a file is of the scene.
    void closeInspector() { inspector_->setOpen(false); }
    [[nodiscard]] visual::VisualServer& visual() { return *visual_; }

private:
    /// The way of a person's input: whoever comes first may keep it. A Gui belongs before all others: what it keeps
    /// neither acts on the run, nor turns the camera, nor is told to observers. They hear of what the other two used.
    void route(std::unique_ptr<event::Event> event)
    {
        // What is for a Gui is for nobody else; observers hear of all else, also of what keys and camera act on.
        if (inspector_->handle(*event) || visual_->handle(*event)) return;
        if (!parts_.haptics.handle(*event) && !act(*event)) steer(*event);
        post(std::move(event));
    }

    /// True: a key of the run.
    bool act(const event::Event& event)
    {
        const auto* key = dynamic_cast<const event::KeyEvent*>(&event);
        const std::optional<RunAction> action = key && parts_.def.look.keys ? actionOf(*key) : std::nullopt;
        if (!action) return false;
        switch (*action) {
        case RunAction::Pause:
            parts_.physics.pause(!parts_.paused.load());
            break;
        case RunAction::Step:
            parts_.stepAsked.store(true);
            break;
        case RunAction::Reset:
            parts_.reset();
            break;
        case RunAction::Screenshot:
            parts_.askScreenshot({});
            break;
        case RunAction::Help:
            keys_->toggle();
            break;
        case RunAction::Quit:
            parts_.finish("Escape");
            break;
        }
        return true;
    }

    void steer(const event::Event& event)
    {
        if (!parts_.steering) return;
        Steering& steering = *parts_.steering;
        if (steering.life.expired()) return parts_.steering.reset();
        const auto* key = dynamic_cast<const event::KeyEvent*>(&event);
        if (key && key->key == event::KeyCode::F) steering.orbit.setScene(parts_.bindings.boundsNow());
        if (steering.orbit.handle(event)) steering.transform->setPose(steering.orbit.pose());
    }

    void post(std::unique_ptr<event::Event> event)
    {
        parts_.stamp(*event);
        if (!parts_.events.tryPost(std::move(event)) && !std::exchange(warned_, true))
            logWarning("events come faster than observers take them: some are lost");
    }

    Simulation::Impl& parts_;
    const DrawnBindings drawn_{parts_.bindings};
    std::unique_ptr<window::Window> window_;
    window::WindowSize size_;
    std::unique_ptr<visual::VisualServer> visual_; ///< after the window: it goes first
    std::optional<VideoFile> video_;
    std::unique_ptr<Inspector> inspector_; ///< after the server, whose Gui it is
    std::unique_ptr<KeyOverlay> keys_;
    bool warned_ = false;
};

void loop(Simulation::Impl& parts, const RunDef& def, Screen& screen)
{
    const Nanoseconds start = parts.clock.now(), end = start + toNanoseconds(def.seconds);
    const Nanoseconds period = toNanoseconds(1.0 / parts.def.look.rate);
    for (Nanoseconds next = start; !parts.stop.load();) {
        screen.input();
        screen.draw(toSeconds(parts.clock.now() - start));
        parts.haptics.drain();
        if (StopSignal::received()) parts.finish("interrupted");
        if (def.seconds > 0.0 && parts.clock.now() >= end) parts.finish(text("ran ", def.seconds, " s"));
        next = std::max(next + period, parts.clock.now());
        parts.clock.sleepUntil(next);
    }
}

} // namespace

RunReport runLive(Simulation::Impl& parts, const RunDef& def)
{
    RunReport report;
    Screen screen(parts, def);
    RunFiles files(parts, def);
    {
        const EventThread events(parts.events);
        PhysicsThread physics(parts, def);
        loop(parts, def, screen);
        physics.join();
        physics.fill(report);
    }
    screen.closeInspector();
    if (!def.picture.empty()) parts.takePicture(screen.visual(), def.picture);
    if (parts.screenshotAsked()) { // by who ended the run
        parts.mapNewestFrame(screen.visual());
        parts.takeScreenshots(screen.visual());
    }
    files.close();
    if (!def.video.empty()) {
        screen.closeVideo();
        parts.pictures.push_back(def.video);
    }
    report.visual = screen.visual().statistics();
    return report;
}

} // namespace filasofia::runtime
