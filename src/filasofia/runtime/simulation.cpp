#include "filasofia/runtime/simulation.h"

#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/engine/native.h"
#include "filasofia/engine/native_engine.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/runtime/parts.h"
#include "filasofia/runtime/stop_signal.h"
#include "filasofia/runtime/surfaces.h"

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

void check(const RunDef& def)
{
    validate(def, "run");
    checkFile("run", def.picture, "picture", ".png");
    checkFile("run", def.log, "log", ".csv");
    checkFile("run", def.record, "record", ".rec");
    checkFile("run", def.video, "video", ".mp4");
    checkFile("run", def.recordMotion, "recordMotion", ".csv");
    if (def.pictureEvery > 0.0 && def.pictureEvery < 1e-3)
        fail("run: pictureEvery must be 0 or >= 0.001 s, got ", def.pictureEvery);
    if (def.pictureEvery > 0.0 && def.picture.empty()) fail("run: pictureEvery needs picture");
    if (def.pictureEvery > 0.0 && !def.headless) fail("run: pictureEvery needs headless");
    if (def.headless && def.seconds > 0.0) fail("run: a headless run ends after steps, not seconds");
}

/// Whoever does not look at the report should hear it once.
void warn(const RunReport& report)
{
    const auto steps = [](std::uint64_t count) { return text("in ", count, count == 1 ? " step" : " steps"); };
    if (report.undone > 0)
        logWarning(steps(report.undone), " a state blew up and was put back (Undone)",
                   report.damped > 0 ? text(", in ", report.damped, " of them to creep on (Damped)") : "");
    if (report.notConverged > 0) logWarning(steps(report.notConverged), " a solver stopped at its cap");
    if (report.outOfTime > 0) logWarning(steps(report.outOfTime), " a solver stopped at the deadline");
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
    if (dress) return dress(visual);
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

void Simulation::Impl::reset()
{
    physics.reset();
    bindings.clearPaint();
    tellScene(SceneCleaned{});
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
    const std::lock_guard lock(reasonMutex);
    report.finished = reason;
}

Simulation::Simulation(const SimulationDef& def) : impl_(std::make_unique<Impl>(def)) {}
Simulation::~Simulation() = default;

BodyId Simulation::add(physics::SoftBodyDef def) { return impl_->physics.add(std::move(def)); }
BodyId Simulation::add(physics::RigidBodyDef def) { return impl_->physics.add(std::move(def)); }
HapticId Simulation::add(const HapticInterfaceDef& def) { return add(def, nullptr); }
HapticId Simulation::add(const HapticInterfaceDef& def, std::unique_ptr<device::HapticDevice> own)
{
    return impl_->haptics.add(def, std::move(own), impl_->physics);
}
HapticState Simulation::haptic(HapticId id) const { return impl_->haptics.state(id); }
void Simulation::placeHaptic(HapticId id, double scale, const Pose& origin) { impl_->haptics.place(id, scale, origin); }
ShownId Simulation::show(BodyId id, const ShowDef& def)
{
    const std::string object = text("show ", physics::describeBody(*impl_->physics.def(id)));
    validate(def, object);
    ShowDef held = def; // with the surface itself: a recording needs no other file
    held.surface = std::string();
    if (auto surface = loadSurface(def.surface, object)) held.surface = std::move(surface);
    const ShownId shown = impl_->bindings.show(id, held, impl_->physics);
    impl_->tellScene(SceneShown{shown.value, id, std::move(held)});
    return shown;
}
void Simulation::setVisible(ShownId id, bool visible)
{
    impl_->bindings.setVisible(id, visible);
    impl_->tellScene(SceneVisible{id.value, visible});
}
void Simulation::setMaterial(ShownId id, const visual::Material& material)
{
    impl_->bindings.setMaterial(id, material);
    impl_->tellScene(SceneMaterial{id.value, material});
}
void Simulation::unshow(ShownId id)
{
    impl_->bindings.remove(id);
    impl_->tellScene(SceneUnshown{id.value});
}
int Simulation::paint(BodyId id, const PaintDef& def)
{
    const int reached = impl_->bindings.paint(id, def, impl_->physics);
    impl_->tellScene(ScenePainted{id, def});
    return reached;
}
void Simulation::follow(visual::Transform& transform, BodyId id, const FollowDef& def)
{
    impl_->bindings.follow(transform, id, def, impl_->physics);
}
void Simulation::unfollow(visual::Transform& transform) { impl_->bindings.unfollow(transform); }
void Simulation::steer(visual::Transform& camera, const visual::OrbitDef& def) { impl_->steer(camera, def); }
void Simulation::screenshot(const std::string& file) { impl_->askScreenshot(file); }
void Simulation::pause(bool paused) { impl_->physics.pause(paused); }
bool Simulation::paused() const { return impl_->paused.load(std::memory_order_relaxed); }
void Simulation::singleStep() { impl_->stepAsked.store(true); }
void Simulation::reset() { impl_->reset(); }
void Simulation::dress(std::function<void(visual::VisualServer&)> scene) { impl_->dress = std::move(scene); }
void Simulation::show(const visual::GuiDef& def)
{
    validate(def, text("gui '", def.name, "'"));
    if (impl_->running.load()) fail("gui '", def.name, "': to be shown before a run, and one is going on");
    impl_->guis.push_back(def);
}

void Simulation::useWindow(std::function<std::unique_ptr<window::Window>(const window::WindowDef&)> open)
{
    impl_->openWindow = std::move(open);
}

void Simulation::everyStep(std::function<void(double)> callback)
{
    if (!callback) fail("simulation: everyStep: the function to call must be one, got nothing");
    if (impl_->running.load()) fail("simulation: everyStep is to be set before a run, and one is going on");
    impl_->everyStep.push_back(std::move(callback));
}

void Simulation::post(std::unique_ptr<event::Event> event)
{
    if (!event) fail("simulation: an event to post must be one, got null");
    impl_->stamp(*event);
    impl_->events.post(std::move(event));
}

event::EventDispatcher& Simulation::events() { return impl_->events; }
physics::PhysicsServer& Simulation::physics() { return impl_->physics; }
void Simulation::tune(std::function<void(engine::Native&)> change) { engine::tune(impl_->physics, std::move(change)); }
void Simulation::finish(std::string why) { impl_->finish(std::move(why)); }

RunReport Simulation::run(const RunDef& def)
{
    check(def);
    if (impl_->running.exchange(true)) fail("simulation: a run is going on; it cannot be run again meanwhile");
    const StopSignal stopSignal;
    impl_->undone = impl_->damped = impl_->notConverged = impl_->outOfTime = 0;
    impl_->contacts.beginRun();
    impl_->pictures.clear();
    impl_->fileProblems.clear();
    try {
        if (impl_->everMade > 0 && !def.record.empty())
            fail("run: record is for a simulation's first run, and this one has made ", impl_->everMade, " steps");
        impl_->haptics.begin(def, impl_->def.physics, impl_->clock, [this](std::unique_ptr<DeviceEvent> event) {
            impl_->stamp(*event);
            static_cast<void>(impl_->events.tryPost(std::move(event))); // full: the log has it
        });
        RunReport report = def.headless ? runHeadless(*impl_, def) : runLive(*impl_, def);
        impl_->haptics.end();
        impl_->fill(report);
        impl_->readyAgain();
        warn(report);
        return report;
    } catch (...) {
        impl_->haptics.abandon();
        impl_->readyAgain();
        throw;
    }
}

} // namespace filasofia::runtime
