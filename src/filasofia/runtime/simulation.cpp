#include "filasofia/runtime/simulation.h"

#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/engine/native/native.h"
#include "filasofia/runtime/check_file.h"
#include "filasofia/runtime/headless_run.h"
#include "filasofia/runtime/live_run.h"
#include "filasofia/runtime/stop_signal.h"
#include "filasofia/runtime/surfaces.h"
#include "filasofia/runtime/video_file.h"

#include <algorithm>
#include <utility>

namespace filasofia::runtime {
namespace {

void check(const RunDef& def)
{
    validate(def, "run");
    checkFile("run", def.picture, "picture", ".png");
    checkFile("run", def.log, "log", ".csv");
    checkFile("run", def.record, "record", ".rec");
    checkVideoFile("run", def.video);
    checkFile("run", def.recordMotion, "recordMotion", ".csv");
    if (def.pictureEvery > 0.0 && def.pictureEvery < 1e-3)
        fail("run: pictureEvery must be 0 or >= 0.001 s, got ", def.pictureEvery);
    if (def.pictureEvery > 0.0 && def.picture.empty()) fail("run: pictureEvery needs a picture file");
    if (def.pictureEvery > 0.0 && !def.headless) fail("run: pictureEvery is for headless runs");
    if (def.headless && def.seconds > 0.0) fail("run: seconds is for live runs; a headless run ends after steps");
}

/// Logs what went wrong, for a caller who does not read the report.
void warn(const RunReport& report)
{
    if (report.undoneAtEnd > 0) logError("physics failed: at the end of the run a body had no finite state");
    const auto isTold = [&](const std::string& line) { // when it happened
        return std::ranges::count(report.nothingHeld, line) + std::ranges::count(report.bluntBlades, line) > 0;
    };
    for (const std::string& line : warnings(report))
        if (!isTold(line)) logWarning(line);
}

} // namespace

Simulation::Simulation(const SimulationDef& def, std::nullptr_t) : impl_(std::make_unique<Impl>(def)) {}
Simulation::~Simulation() = default;

BodyId Simulation::add(physics::SoftBodyDef def) { return impl_->physics.add(std::move(def)); }
BodyId Simulation::add(physics::RigidBodyDef def) { return impl_->physics.add(std::move(def)); }
BodyId Simulation::add(physics::RodBodyDef def) { return impl_->physics.add(std::move(def)); }
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
    ShowDef held = def; // with the surface itself, so that a recording needs no other file
    held.surface = std::string();
    if (auto surface = loadSurface(def.surface, object)) held.surface = std::move(surface);
    const ShownId shown = impl_->bindings.show(id, held, impl_->physics);
    impl_->recordScene(SceneShown{shown.value, id, std::move(held)});
    return shown;
}
void Simulation::setVisible(ShownId id, bool visible)
{
    impl_->bindings.setVisible(id, visible);
    impl_->recordScene(SceneVisible{id.value, visible});
}
void Simulation::setMaterial(ShownId id, const visual::Material& material)
{
    impl_->bindings.setMaterial(id, material);
    impl_->recordScene(SceneMaterial{id.value, material});
}
void Simulation::unshow(ShownId id)
{
    impl_->bindings.remove(id);
    impl_->recordScene(SceneUnshown{id.value});
}
int Simulation::paint(BodyId id, const PaintDef& def)
{
    const int reached = impl_->bindings.paint(id, def, impl_->physics);
    impl_->recordScene(ScenePainted{id, def});
    return reached;
}
void Simulation::bleed(BodyId id, const surface::BleedingDef& def)
{
    const Vec3 gravity = impl_->def.physics.gravity;
    impl_->bleedings.add(id, def, gravity, impl_->physics);
    impl_->recordScene(SceneBled{id, def, gravity});
}
void Simulation::burn(BodyId id, const surface::BurningDef& def)
{
    impl_->burnings.add(id, def, {}, impl_->physics);
    impl_->recordScene(SceneBurnt{id, def});
}
void Simulation::treat(BodyId id, const surface::Treatment& treatment)
{
    impl_->treat(id, treatment);
    impl_->recordScene(SceneTreated{id, treatment});
}
void Simulation::checkTreat(BodyId id, const surface::Treatment& treatment) const
{
    impl_->ofLayer(treatment, [&](auto& layers, const auto& command) { layers.check(id, command, impl_->physics); });
}
int Simulation::addElectrode(BodyId id, const surface::ElectrodeDef& def)
{
    const int index = impl_->electrodes.add(id, def, impl_->physics);
    if (def.mode == surface::EnergyMode::Cut) impl_->physics.setCutting(id, false);
    impl_->recordScene(SceneElectrode{id, def});
    return index;
}
void Simulation::activate(BodyId id, bool on, int electrode)
{
    static_cast<void>(impl_->physics.def(id)); // an Error if it was removed
    const Electrodes::Moved pedal = impl_->electrodes.activate(id, on, electrode);
    if (pedal.cuts) impl_->physics.setCutting(id, *pedal.cuts);
    if (pedal.moved) impl_->recordScene(SceneActivated{id, electrode, on});
}
surface::EnergyBalance Simulation::energy(BodyId id, int electrode) const
{
    return impl_->electrodes.balance(id, electrode);
}
int Simulation::electrodes(BodyId id) const { return impl_->electrodes.count(id); }
int Simulation::addDuct(BodyId id, const surface::DuctDef& def)
{
    const int index = impl_->ducts.add(id, def, impl_->physics);
    impl_->recordScene(SceneDuct{id, def});
    return index;
}
surface::DuctBalance Simulation::duct(BodyId id, int duct) const { return impl_->ducts.balance(id, duct); }
void Simulation::addSmoke(const surface::SmokeDef& def)
{
    const Vec3 gravity = impl_->def.physics.gravity;
    if (impl_->distension.any()) fail("smoke: a fluid distends a cavity, and nothing smokes in it");
    impl_->smoke.add(def, gravity);
    impl_->recordScene(SceneSmoke{def, gravity});
}
void Simulation::extract(const surface::Extract& command)
{
    impl_->smoke.extract(command, impl_->physics);
    impl_->recordScene(SceneExtracted{command});
}
void Simulation::checkExtract(const surface::Extract& command) const { impl_->smoke.check(command, impl_->physics); }
surface::SmokeBalance Simulation::smoke() const { return impl_->smoke.balance(); }
double Simulation::smokeBetween(Vec3 from, Vec3 to) const { return impl_->smoke.depth(from, to); }
void Simulation::addDistension(const surface::DistensionDef& def)
{
    if (impl_->smoke.any()) fail("distension: the simulation has a room for smoke, and nothing smokes in a fluid");
    const Vec3 gravity = impl_->def.physics.gravity;
    impl_->distension.add(def, gravity);
    impl_->recordScene(SceneDistension{def, gravity});
}
void Simulation::distend(const surface::Distend& command)
{
    impl_->distension.apply(command);
    impl_->recordScene(SceneDistended{command});
}
void Simulation::checkDistend(const surface::Distend& command) const { impl_->distension.check(command); }
surface::DistensionBalance Simulation::distension() const { return impl_->distension.balance(); }
surface::BloodBalance Simulation::blood(BodyId id) const { return impl_->bleedings.balance(id); }
surface::HeatBalance Simulation::heat(BodyId id) const { return impl_->burnings.balance(id); }
bool Simulation::bleeds(BodyId id) const { return impl_->bleedings.has(id); }
bool Simulation::burns(BodyId id) const { return impl_->burnings.has(id); }
bool Simulation::hasSmoke() const { return impl_->smoke.any(); }
std::shared_ptr<const std::vector<float>> Simulation::damage(BodyId id) const { return impl_->burnings.damage(id); }
void Simulation::follow(visual::Transform& transform, BodyId id, const FollowDef& def)
{
    impl_->bindings.follow(transform, id, def, impl_->physics);
}
void Simulation::unfollow(visual::Transform& transform) { impl_->bindings.unfollow(transform); }
void Simulation::steer(visual::Transform& camera, const visual::OrbitDef& def)
{
    impl_->steering.begin(camera, def, impl_->bindings);
}
void Simulation::screenshot(const std::string& file) { impl_->screenshots.ask(file); }
void Simulation::pause(bool paused) { impl_->setPaused(paused); }
bool Simulation::paused() const { return impl_->pause.paused(); }
void Simulation::singleStep() { impl_->pause.askSingleStep(); }
void Simulation::reset() { impl_->reset(); }
void Simulation::dress(std::function<void(visual::VisualServer&)> scene)
{
    if (impl_->control.running()) fail("simulation: dress must be set before a run, but one is going on");
    if (scene)
        impl_->picture.dresses.push_back(std::move(scene));
    else
        impl_->picture.dresses.clear();
}
void Simulation::show(const visual::GuiDef& def)
{
    validate(def, text("gui '", def.name, "'"));
    if (impl_->control.running()) fail("gui '", def.name, "': must be shown before a run, but one is going on");
    impl_->picture.guis.push_back(def);
}

void Simulation::useWindow(std::function<std::unique_ptr<window::Window>(const window::WindowDef&)> open)
{
    impl_->picture.openWindow = std::move(open);
}

void Simulation::everyStep(std::function<void(double)> callback)
{
    if (!callback) fail("simulation: everyStep: needs a function to call, got an empty one");
    if (!impl_->control.changeable())
        fail(
            "simulation: everyStep must be set before a run or between two steps of a stepped run, but a run or a step "
            "is going on");
    impl_->everyStep.add(std::move(callback));
}

void Simulation::remember(Memory memory)
{
    if (memory.of.empty() || !memory.save || !memory.restore)
        fail("simulation: remember: of, save and restore must not be empty");
    if (!impl_->control.changeable())
        fail("simulation: remember must be called before a run or between two steps of a stepped run, but a run or a "
             "step is going on");
    impl_->memories.add(std::move(memory));
}

void Simulation::post(std::unique_ptr<event::Event> event)
{
    if (!event) fail("simulation: post: the event must not be null");
    impl_->now.stamp(*event);
    impl_->events.post(std::move(event));
}

event::EventDispatcher& Simulation::events() { return impl_->events; }
physics::PhysicsServer& Simulation::physics() { return impl_->physics; }
void Simulation::useEngine(const std::string& name) { impl_->useEngine(name); }
void Simulation::tune(std::function<void(engine::Native&)> change) { engine::tune(impl_->physics, std::move(change)); }
void Simulation::finish(std::string why) { impl_->control.finish(std::move(why)); }

RunReport Simulation::run(const RunDef& def)
{
    check(def);
    if (!impl_->control.begin()) fail("simulation: a run is going on; the next one cannot start before it ends");
    const StopSignal stopSignal;
    impl_->beginRun();
    try {
        if (impl_->counters.stepsEver() > 0 && !def.record.empty())
            fail("run: record is for a simulation's first run, but this one has already made ",
                 impl_->counters.stepsEver(), " steps");
        impl_->haptics.begin(def, impl_->def.physics, impl_->clock, [this](std::unique_ptr<DeviceEvent> event) {
            impl_->now.stamp(*event);
            static_cast<void>(impl_->events.tryPost(std::move(event))); // if the queue is full, the log still has it
        });
        RunReport report = def.headless ? runHeadless(*impl_, def) : runLive(*impl_, def);
        impl_->haptics.end();
        impl_->fill(report);
        impl_->endRun();
        warn(report);
        return report;
    } catch (...) {
        impl_->haptics.abandon();
        impl_->endRun();
        throw;
    }
}

} // namespace filasofia::runtime
