#include "filasofia/runtime/parts.h"

#include "filasofia/core/log.h"
#include "filasofia/runtime/inspector.h"
#include "filasofia/runtime/physics_loop.h"
#include "filasofia/runtime/run_files.h"
#include "filasofia/runtime/stop_signal.h"

#include <algorithm>
#include <thread>

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
        if (window_) visual_->setGuiScale(window_->scale());
        parts.bindings.addPending(*visual_);
        parts.dressScene(*visual_);
        inspector_ = std::make_unique<Inspector>(parts, *visual_);
    }

    void input()
    {
        if (!window_) return;
        window_->poll([this](std::unique_ptr<event::Event> event) {
            if (inspector_->handle(*event) || visual_->handle(*event)) return; // it was for a Gui
            post(std::move(event));
        });
        window_->setTextInput(visual_->wantsText());
        if (window_->shouldClose()) parts_.finish("window closed");
        if (const window::WindowSize now = window_->size(); now != size_) {
            size_ = now;
            visual_->resize(std::clamp(now.width, 1, kLargestPicture), std::clamp(now.height, 1, kLargestPicture));
        }
    }
    void draw()
    {
        parts_.mapNewestFrame(*visual_);
        inspector_->beforePicture();
        if (visual_->render()) post(std::make_unique<event::VisualUpdateEvent>());
        inspector_->afterPicture();
    }
    /// A picture for a file is of the scene.
    void closeInspector() { inspector_->setOpen(false); }
    [[nodiscard]] visual::VisualServer& visual() { return *visual_; }

private:
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
    std::unique_ptr<Inspector> inspector_;         ///< after the server, whose Gui it is
    bool warned_ = false;
};

void loop(Simulation::Impl& parts, const RunDef& def, Screen& screen, RunFiles& files)
{
    const Nanoseconds start = parts.clock.now(), end = start + toNanoseconds(def.seconds);
    const Nanoseconds period = toNanoseconds(1.0 / parts.def.look.rate);
    for (Nanoseconds next = start; !parts.stop.load();) {
        screen.input();
        screen.draw();
        files.drain();
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
        loop(parts, def, screen, files);
        physics.join();
        physics.fill(report);
    }
    files.close();
    if (!def.picture.empty()) {
        screen.closeInspector();
        parts.takePicture(screen.visual(), def.picture);
        report.pictures.push_back(def.picture);
    }
    report.visual = screen.visual().statistics();
    return report;
}

} // namespace filasofia::runtime
