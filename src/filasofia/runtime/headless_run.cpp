#include "filasofia/runtime/parts.h"

#include "filasofia/core/text.h"
#include "filasofia/runtime/physics_loop.h"
#include "filasofia/runtime/run_files.h"
#include "filasofia/runtime/stop_signal.h"

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

constexpr double kRounding = 1e-9; // [s], 250 steps of 5 ms sum to a little less than 1.25 s

/// Pictures of a run that has no window: an own visual server, only when there is something to draw.
class Pictures {
public:
    Pictures(Simulation::Impl& parts, const RunDef& def) : parts_(parts), def_(def)
    {
        if (def.picture.empty()) return;
        visual_ = std::make_unique<visual::VisualServer>(visual::VisualServerDef{
            .backend = visual::Backend::Headless, .width = parts.def.window.width, .height = parts.def.window.height});
        parts.bindings.addPending(*visual_);
        parts.dressScene(*visual_);
    }
    void afterStep(double time)
    {
        if (def_.pictureEvery == 0.0 || time + kRounding < next_) return;
        next_ = (std::floor((time + kRounding) / def_.pictureEvery) + 1.0) * def_.pictureEvery;
        take(numbered(def_.picture, time));
    }
    void last()
    {
        if (visual_ && def_.pictureEvery == 0.0) take(def_.picture);
    }
    void fill(RunReport& report) const
    {
        report.pictures = files_;
        if (visual_) report.visual = visual_->statistics();
    }

private:
    void take(const std::string& file)
    {
        parts_.takePicture(*visual_, file);
        files_.push_back(file);
    }

    Simulation::Impl& parts_;
    const RunDef& def_;
    const DrawnBindings drawn_{parts_.bindings};
    std::unique_ptr<visual::VisualServer> visual_;
    std::vector<std::string> files_;
    double next_ = 0.0;
};

} // namespace

RunReport runHeadless(Simulation::Impl& parts, const RunDef& def)
{
    Pictures pictures(parts, def);
    RunFiles files(parts, def);

    const PhysicsLoopDef loop{
        .period = parts.period(), .freeRunning = true, .maximumSteps = static_cast<std::uint64_t>(def.steps)};
    RunReport report;
    const auto afterStep = [&](const physics::StepReport& step) {
        const std::uint32_t flags = parts.afterStep(step);
        parts.events.deliverAll(); // before the next step begins: observers' commands come at the same step every time
        files.drain();
        pictures.afterStep(step.time);
        if (StopSignal::received()) parts.finish("interrupted");
        return flags;
    };
    report.timing =
        runPhysics(parts.physics, loop, parts.clock, parts.stop, afterStep, [&](double dt) { parts.beforeStep(dt); });
    files.close();
    parts.finish(text("made ", report.timing.stepCount, report.timing.stepCount == 1 ? " step" : " steps"));
    pictures.last();
    pictures.fill(report);
    return report;
}

} // namespace filasofia::runtime
