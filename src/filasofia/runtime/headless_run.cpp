#include "filasofia/runtime/headless_run.h"

#include "filasofia/core/text.h"
#include "filasofia/runtime/physics_loop.h"
#include "filasofia/runtime/run_files.h"
#include "filasofia/runtime/stop_signal.h"
#include "filasofia/runtime/video_file.h"

#include <cmath>
#include <filesystem>

namespace filasofia::runtime {
namespace {

/// "out/bunny.png" at 250 ms -> "out/bunny_0250ms.png": files sort by time.
std::string numbered(const std::string& picture, double time)
{
    const std::filesystem::path path(picture);
    std::string milliseconds = std::to_string(std::lround(time * 1e3));
    milliseconds.insert(0, milliseconds.size() < 4 ? 4 - milliseconds.size() : 0, '0');
    return (path.parent_path() / text(path.stem().string(), "_", milliseconds, "ms.png")).string();
}

constexpr double kTimeRounding = 1e-9; // [s]; 250 steps of 5 ms sum to a little less than 1.25 s

/// Pictures of a run that has no window. Makes a visual server of its own, but only if there is something to draw.
class Pictures {
public:
    Pictures(Simulation::Impl& impl, const RunDef& def) : impl_(impl), def_(def)
    {
        if (!def.video.empty()) video_.emplace(def.video, impl.def.window.width, impl.def.window.height, def.fps);
        if (!def.picture.empty() || video_) open();
    }
    void afterStep(double time)
    {
        if (def_.pictureEvery > 0.0 && time + kTimeRounding >= next_) {
            next_ = (std::floor((time + kTimeRounding) / def_.pictureEvery) + 1.0) * def_.pictureEvery;
            impl_.takePicture(*visual_, numbered(def_.picture, time));
        }
        const bool film = video_ && video_->due(time - start_);
        const bool asked = impl_.screenshots.asked();
        if (!film && !(asked && opened())) return;
        impl_.mapFinishedFrame(*visual_);
        if (film && !impl_.files.attempt([&] { video_->show(visual_->capture(), time - start_); })) video_.reset();
        impl_.takeScreenshots(*visual_);
    }
    void last(RunReport& report)
    {
        if (!def_.picture.empty() && def_.pictureEvery == 0.0) impl_.takePicture(*visual_, def_.picture);
        if (video_ && impl_.files.attempt([this] { video_->close(); })) impl_.files.addPicture(def_.video);
        if (visual_) report.visual = visual_->statistics();
    }

private:
    /// A screenshot may be the first thing to be drawn. If nothing can be drawn, the run goes on without it.
    bool opened()
    {
        try {
            open();
            return true;
        } catch (const Error& problem) {
            impl_.screenshots.drop(problem);
            return false;
        }
    }

    void open()
    {
        if (visual_) return;
        visual_ = std::make_unique<visual::VisualServer>(visual::VisualServerDef{
            .backend = visual::Backend::Headless, .width = impl_.def.window.width, .height = impl_.def.window.height});
        impl_.bindings.forgetRemoved(impl_.physics);
        impl_.bindings.addPending(*visual_);
        impl_.dressScene(*visual_);
    }

    Simulation::Impl& impl_;
    const RunDef& def_;
    const double start_ = impl_.now.seconds(); ///< [s], simulated time at which the run begins
    std::optional<VideoFile> video_;
    const DrawnBindings drawn_{impl_.bindings};
    std::unique_ptr<visual::VisualServer> visual_;
    double next_ = 0.0;
};

} // namespace

RunReport runHeadless(Simulation::Impl& impl, const RunDef& def)
{
    Pictures pictures(impl, def);
    RunFiles files(impl, def);

    const PhysicsLoopDef loop{.period = impl.period(),
                              .freeRunning = true,
                              .step = impl.step(),
                              .maxSteps = static_cast<std::uint64_t>(def.steps)};
    RunReport report;
    const auto afterStep = [&](const physics::StepReport& step) {
        const std::uint32_t flags = impl.afterStep(step);
        // Before the next step begins, so that observers' commands reach the same step in every run.
        impl.events.deliverAll();
        files.keepUp();
        impl.haptics.drain();
        pictures.afterStep(step.time);
        if (StopSignal::received()) impl.control.finish("interrupted");
        return flags;
    };
    report.timing = runPhysics(impl.physics, loop, impl.clock, impl.control.stopAsked(), afterStep,
                               [&](double dt) { impl.beforeStep(dt); });
    impl.control.finish(text("made ", report.timing.stepCount, report.timing.stepCount == 1 ? " step" : " steps"));
    pictures.last(report);
    files.close(); // after the last picture: the files record how it was taken
    return report;
}

} // namespace filasofia::runtime
