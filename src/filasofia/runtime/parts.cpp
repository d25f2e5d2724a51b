#include "filasofia/runtime/parts.h"

#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"

#include <filesystem>
#include <limits>
#include <utility>

namespace filasofia::runtime {
namespace {

const SimulationDef& checked(const SimulationDef& def)
{
    validate(def, "simulation");
    if (length(def.look.direction) == 0.0) fail("simulation: look.direction must have a length > 0, got 0 0 0");
    if (def.look.around && geometry::isEmpty(*def.look.around))
        fail("simulation: look.around: high must be >= low in every axis");
    return def;
}

std::unique_ptr<physics::PhysicsEngine> engineFor(const PhysicsDef& def)
{
    return engine::makeNativeEngine({.period = 1.0 / def.rate, .threads = def.threads, .contact = def.contact});
}

constexpr auto kEventLost = static_cast<std::uint32_t>(physics::StepFlag::EventLost);

/// "filasofia_001.png", or the first number that is free.
std::string freePictureName()
{
    for (int number = 1;; ++number) {
        const std::string digits = std::to_string(number);
        const std::string name =
            text("filasofia_", std::string(3 - std::min<std::size_t>(3, digits.size()), '0'), digits, ".png");
        std::error_code ignored;
        if (!std::filesystem::exists(name, ignored)) return name;
    }
}

} // namespace

void checkFile(const char* object, const std::string& file, const char* field, const char* extension)
{
    if (file.empty()) return;
    const std::filesystem::path path(file);
    const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    if (path.extension() != extension) fail(object, ": ", field, " must end in ", extension, ", got '", file, "'");
    std::error_code problem; // a name too long, a folder that may not be entered, a link in a circle
    if (!std::filesystem::is_directory(folder, problem))
        fail(object, ": ", field, " '", file, "': there is no such folder");
    const auto status = std::filesystem::status(path, problem);
    if (std::filesystem::is_directory(status)) fail(object, ": ", field, " '", file, "' is a folder");
    if (!std::filesystem::status_known(status)) fail(object, ": ", field, " '", file, "': ", problem.message());
}

Simulation::Impl::Impl(const SimulationDef& asked) : Impl(asked, engineFor(checked(asked).physics)) {}

Simulation::Impl::Impl(const SimulationDef& asked, std::unique_ptr<physics::PhysicsEngine> engine)
    : def(checked(asked)), physics(std::move(engine), {.gravity = asked.physics.gravity})
{
}

Nanoseconds Simulation::Impl::deadline() const
{
    const double seconds = def.physics.deadline.value_or(1.0 / def.physics.rate);
    // Above a century it is none: nanoseconds end at three.
    return seconds < 3e9 ? toNanoseconds(seconds) : std::numeric_limits<Nanoseconds>::max();
}

void Simulation::Impl::finish(std::string why)
{
    const std::lock_guard lock(reasonMutex);
    if (reason.empty()) reason = std::move(why);
    stop.store(true);
}

void Simulation::Impl::readyAgain()
{
    const std::lock_guard lock(reasonMutex);
    reason.clear();
    stop.store(false);
    steering.reset();
    journal.close(); // a recording is of the first run
    running.store(false);
}

void Simulation::Impl::stamp(event::Event& event) const
{
    event.time = time.load(std::memory_order_relaxed);
    event.step = step.load(std::memory_order_relaxed);
}

std::uint32_t Simulation::Impl::afterStep(const physics::StepReport& report)
{
    time.store(report.time, std::memory_order_relaxed);
    step.store(report.step, std::memory_order_relaxed);
    const bool single = std::exchange(stepping, false);
    if (single) physics.pause(true);
    pauseComes = single;
    paused.store(single || physics.paused(), std::memory_order_relaxed);
    ++everMade;
    undone += report.has(physics::StepFlag::Undone);
    damped += report.has(physics::StepFlag::Damped);
    notConverged += report.has(physics::StepFlag::NotConverged);
    outOfTime += report.has(physics::StepFlag::OutOfTime);
    feed.write(report);
    haptics.afterStep(report, physics);
    // First: who hears of the step has heard of what happened in it.
    const std::uint32_t flags = tellContacts(report) | tellRuptures(report);
    auto update = std::make_unique<event::PhysicsUpdateEvent>();
    stamp(*update);
    return flags | (events.tryPost(std::move(update)) ? 0u : kEventLost);
}

void Simulation::Impl::beforeStep(double dt)
{
    // A single step goes on and is paused again: as commands, so that a recording has it.
    const bool stands = physics.paused() || pauseComes;
    if (stepAsked.exchange(false) && stands) {
        physics.pause(false);
        stepping = true;
    }
    if (stands && !stepping) return;
    const double end = time.load(std::memory_order_relaxed) + dt;
    haptics.beforeStep(dt, end, physics);
    for (auto& callback : everyStep) {
        if (!callback) continue;
        try {
            callback(end);
        } catch (const std::exception& problem) { // as of an observer: one mistake does not end physics
            logError("simulation: everyStep: ", problem.what(), "; it is not called again");
            callback = nullptr;
        }
    }
}

std::uint32_t Simulation::Impl::tellContacts(const physics::StepReport& report)
{
    if (!contacts.concerns(report)) return 0;
    const auto post = [this](std::unique_ptr<ContactEvent> event) {
        stamp(*event);
        return events.tryPost(std::move(event));
    };
    if (report.contacts.active == 0) return contacts.observe({}, post) ? 0u : kEventLost;
    const frame::FrameRef frame = physics.latest();
    // Readers that hold all frames keep this step's contacts from us: the next step tells.
    if (!frame || frame->step != report.step) return kEventLost;
    return contacts.observe(frame->contacts, post) ? 0u : kEventLost;
}

std::uint32_t Simulation::Impl::tellRuptures(const physics::StepReport& report)
{
    bool all = true;
    const auto post = [&](auto event, const physics::Rupture& rupture) {
        event->rupture = rupture;
        stamp(*event);
        all = events.tryPost(std::move(event)) && all;
    };
    for (const physics::Rupture& rupture : report.topology.ruptures)
        if (rupture.kind == physics::Rupture::Kind::Cut)
            post(std::make_unique<CutEvent>(), rupture);
        else
            post(std::make_unique<TearEvent>(), rupture);
    return all ? 0u : kEventLost;
}

void Simulation::Impl::dressScene(visual::VisualServer& visual)
{
    for (const visual::GuiDef& gui : guis) visual.add(gui);
    for (const auto& dress : dresses) dress(visual);
    if (!dresses.empty()) return;
    const geometry::Box bounds = def.look.around ? *def.look.around : bindings.bounds();
    if (geometry::isEmpty(bounds)) return; // nothing is shown yet: the picture stays dark
    const visual::EndoscopeLook look =
        visual::addEndoscopeLook(visual, {bounds.low, bounds.high}, def.look.quality, def.look.direction);
    if (def.look.mouse)
        steer(*look.rig, {.around = bounds,
                          .start = look.rig->pose(),
                          .verticalFieldOfView = look.camera->def().verticalFieldOfView,
                          .width = visual.width(),
                          .height = visual.height()});
}

void Simulation::Impl::mapNewestFrame(visual::VisualServer& visual)
{
    bindings.addPending(visual);
    if (const frame::FrameRef frame = physics.latest()) bindings.update(*frame, physics, visual);
    journal.observe(visual, step.load(std::memory_order_relaxed));
}

void Simulation::Impl::mapFinishedFrame(visual::VisualServer& visual)
{
    const frame::FrameRef frame = physics.latest();
    bindings.finishMeshes(frame ? &*frame : nullptr);
    mapNewestFrame(visual);
}

void Simulation::Impl::takePicture(visual::VisualServer& visual, const std::string& file)
{
    mapFinishedFrame(visual);
    visual::savePng(visual.capture(), file);
    pictures.push_back(file);
}

void Simulation::Impl::steer(visual::Transform& camera, const visual::OrbitDef& orbit)
{
    if (!bindings.visual() || !bindings.visual()->has(camera))
        fail("steer: the camera is not one of the visual server's, or there is none yet");
    if (camera.parent()) fail("steer: '", camera.name(), "' hangs on '", camera.parent()->name(), "': steer that");
    steering = Steering{visual::OrbitCamera(orbit), &camera, camera.life()};
    camera.setPose(steering->orbit.pose());
}

void Simulation::Impl::askScreenshot(const std::string& file)
{
    checkFile("run", file, "screenshot", ".png");
    const std::lock_guard lock(screenshotMutex);
    screenshots.push_back(file);
}

bool Simulation::Impl::screenshotAsked()
{
    const std::lock_guard lock(screenshotMutex);
    return !screenshots.empty();
}

void Simulation::Impl::dropScreenshots(const Error& why)
{
    const std::lock_guard lock(screenshotMutex);
    screenshots.clear();
    logError("screenshot: ", why.what());
}

void Simulation::Impl::takeScreenshots(visual::VisualServer& visual)
{
    std::vector<std::string> files;
    {
        const std::lock_guard lock(screenshotMutex);
        files.swap(screenshots);
    }
    if (files.empty()) return;
    const visual::Image image = visual.capture();
    for (std::string& file : files) {
        if (file.empty()) file = freePictureName();
        try {
            visual::savePng(image, file);
            pictures.push_back(file);
        } catch (const Error& problem) { // whoever asked is far away, and the run goes on
            logError("screenshot: ", problem.what());
            pictureProblems.emplace_back(problem.what());
        }
    }
}

void Simulation::Impl::fill(RunReport& report)
{
    report.time = time.load();
    report.steps = step.load();
    report.hash = physics.hash();
    report.undone = undone;
    report.damped = damped;
    report.notConverged = notConverged;
    report.outOfTime = outOfTime;
    report.contacts = contacts.report(physics);
    report.pictures = pictures;
    report.fileProblems = fileProblems;
    report.fileProblems.insert(report.fileProblems.end(), pictureProblems.begin(), pictureProblems.end());
    const std::lock_guard lock(reasonMutex);
    report.finished = reason;
}

} // namespace filasofia::runtime
