#include "filasofia/runtime/simulation_impl.h"

#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/core/word.h"
#include "filasofia/runtime/engines.h"
#include "filasofia/sofa/load.h"

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

constexpr auto kEventLost = static_cast<std::uint32_t>(physics::StepFlag::EventLost);

} // namespace

Simulation::Impl::Impl(const SimulationDef& asked) : Impl(asked, engineFor(checked(asked))) {}

Simulation::Impl::Impl(const SimulationDef& asked, std::unique_ptr<physics::PhysicsEngine> engine)
    : def(checked(asked)), physics(std::move(engine), {.gravity = asked.physics.gravity})
{
    memories.add(bleedings.memory());
    memories.add(burnings.memory());
    memories.add(electrodes.memory());
    memories.add(ducts.memory());
    memories.add(smoke.memory());
    memories.add(distension.memory());
}

std::unique_ptr<physics::PhysicsEngine> Simulation::Impl::engineFor(const SimulationDef& def)
try {
    const PhysicsDef& paced = def.physics;
    return makeEngine(def.engine.empty() ? engineNames().front() : def.engine,
                      {.period = 1.0 / paced.rate, .threads = paced.threads, .contact = paced.contact});
} catch (const Error& problem) {
    fail("simulation: ", problem.what());
}

void Simulation::Impl::useEngine(const std::string& name)
{
    if (control.running()) fail("simulation: the engine must be chosen before a run, but one is going on");
    if (name == physics.engine().info().name) return;
    if (sofaengine::isLoadedScene(physics.engine()))
        fail("engine: a loaded scene of SOFA runs with no other engine, got ", shownWord(name));
    SimulationDef other = def;
    other.engine = name;
    std::unique_ptr<physics::PhysicsEngine> engine = engineFor(other);
    burnings.check(*engine, physics);
    physics.useEngine(std::move(engine));
    def.engine = name;
}

Nanoseconds Simulation::Impl::deadline() const
{
    const double seconds = def.physics.deadline.value_or(1.0 / def.physics.rate);
    // Above a century there is no deadline; 64-bit nanoseconds overflow at three centuries.
    return seconds < 3e9 ? toNanoseconds(seconds) : std::numeric_limits<Nanoseconds>::max();
}

void Simulation::Impl::beginRun()
{
    counters.begin();
    contacts.beginRun();
    files.begin();
}

void Simulation::Impl::endRun()
{
    if (counters.stepsEver() > 0) journal.close(); // only the first run can be recorded, but a refused one was none
    steering.end();
    control.end();
}

std::uint32_t Simulation::Impl::afterStep(const physics::StepReport& report)
{
    now.set(report.time, report.step);
    pause.endStep(physics);
    counters.count(report);
    if (counters.newlyUndone())
        logWarning("at ", report.time, " s the new state of ",
                   report.undone.empty() ? "a body" : text("'", nameOf(report.undone.front(), physics), "'"),
                   " was not finite and was rolled back (Undone); ",
                   report.has(physics::StepFlag::Damped) ? "it advanced with damping (Damped)" : "it stood still");
    feed.write(report);
    haptics.afterStep(report, physics);
    // Before the update event, so that its observers already know what happened in the step.
    std::uint32_t flags = postContactEvents(report);
    flags |= postIntersectionEvents(report);
    flags |= postChangeEvents(report);
    flags |= stepSurfaces(report);
    flags |= stepDucts(report); // what they pour is recorded now, so it is there from the next step on, as in a replay
    auto update = std::make_unique<event::PhysicsUpdateEvent>();
    now.stamp(*update);
    return flags | (events.tryPost(std::move(update)) ? 0u : kEventLost);
}

void Simulation::Impl::beforeStep(double dt)
{
    if (!pause.beginStep(physics)) return;
    const double end = now.seconds() + dt;
    haptics.beforeStep(dt, end, physics);
    everyStep.call(end);
}

std::uint32_t Simulation::Impl::postContactEvents(const physics::StepReport& report)
{
    if (!contacts.concerns(report)) return 0;
    const auto post = [this](std::unique_ptr<ContactEvent> event) {
        now.stamp(*event);
        return events.tryPost(std::move(event));
    };
    const bool solved = !report.has(physics::StepFlag::NotConverged) && !report.has(physics::StepFlag::OutOfTime);
    if (report.contacts.active == 0) return contacts.observe({}, solved, post) ? 0u : kEventLost;
    const frame::FrameRef frame = physics.latest();
    // If readers hold all frames, we do not get this step's contacts; the next step reports the loss.
    if (!frame || frame->step != report.step) return kEventLost;
    return contacts.observe(frame->contacts, solved, post) ? 0u : kEventLost;
}

std::uint32_t Simulation::Impl::postIntersectionEvents(const physics::StepReport& report)
{
    const auto post = [this](std::unique_ptr<IntersectionEvent> event) {
        now.stamp(*event);
        return events.tryPost(std::move(event));
    };
    return intersections.observe(report.intersections, post) ? 0u : kEventLost;
}

std::uint32_t Simulation::Impl::postChangeEvents(const physics::StepReport& report)
{
    bool all = true;
    const auto post = [&](auto event, auto member, const auto& change) {
        (*event).*member = change;
        now.stamp(*event);
        all = events.tryPost(std::move(event)) && all;
    };
    for (const physics::Rupture& each : report.topology.ruptures)
        if (each.kind == physics::Rupture::Kind::Cut)
            post(std::make_unique<CutEvent>(), &CutEvent::rupture, each);
        else
            post(std::make_unique<TearEvent>(), &TearEvent::rupture, each);
    for (const physics::ClipChange& each : report.clipChanges)
        post(std::make_unique<ClipEvent>(), &ClipEvent::change, each);
    for (const physics::AttachmentBreak& each : report.breaks)
        post(std::make_unique<BreakEvent>(), &BreakEvent::attachment, each);
    return all ? 0u : kEventLost;
}

std::uint32_t Simulation::Impl::stepSurfaces(const physics::StepReport& report)
{
    const auto burnt = [this](BodyId id, const surface::BurningDef& how, const surface::HeatBalance& balance) {
        auto event = std::make_unique<BurnEvent>();
        event->body = id;
        event->target = how.target;
        event->injury = !how.target && balance.burnt > 0.0;
        event->balance = balance;
        now.stamp(*event);
        return events.tryPost(std::move(event));
    };
    const auto bled = [this](BodyId id, const surface::BleedingDef&, const surface::BloodBalance& balance) {
        auto event = std::make_unique<BleedingEvent>();
        event->body = id;
        event->balance = balance;
        now.stamp(*event);
        return events.tryPost(std::move(event));
    };
    const auto given = [this](BodyId id, int electrode, bool active, const surface::EnergyBalance& balance) {
        auto event = std::make_unique<EnergyEvent>();
        event->body = id;
        event->electrode = electrode;
        event->active = active;
        event->balance = balance;
        now.stamp(*event);
        return events.tryPost(std::move(event));
    };
    bool all = stepSurfaces(report.step, report.time, burnt, bled, given);
    all = postDistension() && all;
    changeHeatedTissue();
    return all ? 0u : kEventLost;
}

bool Simulation::Impl::postDistension()
{
    const auto told = distension.takeTold();
    if (!told) return true;
    auto event = std::make_unique<DistensionEvent>();
    event->balance = *told;
    now.stamp(*event);
    return events.tryPost(std::move(event));
}

/// By commands, which the recording of physics has: a replay does without this.
void Simulation::Impl::changeHeatedTissue()
{
    const std::lock_guard lock(heatMutex);
    for (const physics::SetTissue& each : burnings.takeTissue()) try {
            if (physics.has(each.id)) physics.setTissue(each.id, each.region, each.factors);
        } catch (const Error& problem) { // a thread has removed the body meanwhile
            logWarning("heat: a change of tissue came too late: ", problem.what());
        }
}

bool Simulation::Impl::stepSurfaces(std::uint64_t step, double time, const SurfaceLayers<surface::Burning>::Post& burnt,
                                    const SurfaceLayers<surface::Bleeding>::Post& bled, const Electrodes::Post& given)
{
    const bool told = electrodes.afterStep(step, time, physics, burnings, given);
    const bool first = burnings.afterStep(step, time, physics, burnt);
    bleedings.close(burnings.takeBurnt());
    smoke.afterStep(step, time, physics, burnings);
    const bool second = bleedings.afterStep(step, time, physics, bled);
    distension.afterStep(step, time, physics, {bleedings, electrodes});
    return told && first && second;
}

std::uint32_t Simulation::Impl::stepDucts(const physics::StepReport& report)
{
    const auto post = [this](BodyId id, int duct, const surface::DuctBalance& balance) {
        auto event = std::make_unique<DuctEvent>();
        event->body = id;
        event->duct = duct;
        event->balance = balance;
        now.stamp(*event);
        return events.tryPost(std::move(event));
    };
    const auto give = [this](BodyId id, const surface::Treatment& treatment) {
        if (!bleedings.has(id)) return;
        treat(id, treatment);
        recordScene(SceneTreated{id, treatment});
    };
    const auto seal = [give](BodyId id, Vec3 place, double radius) { give(id, surface::Seal{place, radius}); };
    const auto pour = [give](BodyId id, Vec3 place, double radius, double volume) {
        give(id, surface::Pour{place, radius, volume});
    };
    return ducts.afterStep(report.step, report.time, physics, {post, seal, pour}) ? 0u : kEventLost;
}

void Simulation::Impl::cleanSurfaces()
{
    bindings.clearPaint();
    bleedings.restart();
    burnings.restart();
    electrodes.restart();
    ducts.restart();
    smoke.restart();
    distension.restart();
}

void Simulation::Impl::treat(BodyId id, const surface::Treatment& treatment)
{
    ofLayer(treatment, [&](auto& layers, const auto& command) { layers.treat(id, command, physics); });
}

std::vector<Vec3> Simulation::Impl::pointsNow(visual::VisualServer& visual)
{
    const frame::FrameRef frame = physics.latest();
    if (!frame) return bindings.points();
    bindings.update(*frame, physics, visual);
    std::vector<Vec3> shown = bindings.pointsNow();
    return shown.empty() ? bindings.points() : shown;
}

void Simulation::Impl::dressScene(visual::VisualServer& visual, Framed framed)
{
    smoke.showAgain();
    distension.showAgain();
    unseen.lookAgain();
    for (const visual::GuiDef& gui : picture.guis) visual.add(gui);
    for (const auto& dress : picture.dresses) dress(visual);
    if (!picture.dresses.empty()) return;
    geometry::Box bounds;
    if (def.look.around) {
        bounds = *def.look.around;
    } else {
        const std::vector<Vec3> points = framed == Framed::Now ? pointsNow(visual) : bindings.points();
        if (points.empty()) return; // nothing is shown yet, so the picture stays dark
        const double aspect = visual.height() > 0 ? double(visual.width()) / visual.height() : 1.0;
        bounds = visual::framing(geometry::boxAround(points), points, aspect, def.look.direction);
    }
    const visual::EndoscopeLook look =
        visual::addEndoscopeLook(visual, {bounds.low, bounds.high}, def.look.quality, def.look.direction);
    if (def.look.mouse)
        steering.begin(*look.rig,
                       {.around = bounds,
                        .start = look.rig->pose(),
                        .verticalFieldOfView = look.camera->def().verticalFieldOfView,
                        .width = visual.width(),
                        .height = visual.height()},
                       bindings);
}

void Simulation::Impl::mapNewestFrame(visual::VisualServer& visual)
{
    bindings.forgetRemoved(physics);
    bindings.addPending(visual);
    bindings.setFilms(bleedings.takeFilms(), burnings.takeFilms());
    if (const auto seen = smoke.takePicture()) visual.setSmoke(*seen);
    distension.draw(visual);
    if (const frame::FrameRef frame = physics.latest())
        bindings.update(picture.drawn ? picture.drawn(*frame) : *frame, physics, visual);
    unseen.look(visual);
    journal.observe(visual, now.step());
}

void Simulation::Impl::mapFinishedFrame(visual::VisualServer& visual)
{
    const frame::FrameRef frame = physics.latest();
    bindings.finishMeshes(!frame ? nullptr : picture.drawn ? &picture.drawn(*frame) : &*frame);
    mapNewestFrame(visual);
}

void Simulation::Impl::takePicture(visual::VisualServer& visual, const std::string& file)
{
    mapFinishedFrame(visual);
    files.savePicture(visual.capture(), file);
}

void Simulation::Impl::reset()
{
    const std::lock_guard lock(heatMutex); // a change of tissue posted in between would follow the reset
    physics.reset();
    haptics.realign(physics);
    for (const BodyId each : electrodes.cutting())
        if (physics.has(each)) physics.setCutting(each, false);
    cleanSurfaces();
    static const SceneEvent cleaned = SceneCleaned{}; // GCC 12 warns about a temporary as uninitialized
    recordScene(cleaned);
}

void Simulation::Impl::fill(RunReport& report) const
{
    report.time = now.seconds();
    report.steps = now.step();
    report.hash = physics.hash();
    counters.fill(report);
    if (counters.firstUndone()) report.undoneBody = nameOf(counters.firstUndone(), physics);
    if (report.inverted > 0) report.worstInvertedBody = nameOf(report.worstInverted.body, physics);
    if (report.intersecting > 0) {
        report.deepestBodies[0] = nameOf(report.deepestIntersection.first, physics);
        report.deepestBodies[1] = nameOf(report.deepestIntersection.second, physics);
    }
    if (report.beyondStrain > 0) report.worstStrainedBody = nameOf(report.worstStrained.body, physics);
    if (report.restless > 0) report.worstUnrestBody = nameOf(report.worstUnrest.body, physics);
    const auto addNamed = [&](const auto& byBody, auto& to) {
        for (const auto& [body, each] : byBody) {
            to.push_back(each);
            to.back().body = nameOf(body, physics);
        }
    };
    addNamed(counters.opened(), report.opened);
    addNamed(counters.lost(), report.lost);
    report.contacts = contacts.report(physics);
    bleedings.fill(report);
    burnings.fill(report);
    electrodes.fill(report, burnings);
    ducts.fill(report);
    smoke.fill(report);
    distension.fill(report);
    report.nothingHeld = counters.attachments().nothing(physics);
    report.broke = counters.attachments().broke(physics);
    report.bluntBlades = blades.lines();
    for (const BodyId each : counters.idleBlades())
        report.bluntBlades.push_back(
            text("blade of '", nameOf(each, physics), "' cuts nothing: no body that may be cut has its group"));
    report.callbackProblems = everyStep.problems();
    files.fill(report);
    report.finished = control.reason();
}

} // namespace filasofia::runtime
