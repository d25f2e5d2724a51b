#include "simulation.h"

#include "defs.h"
#include "frames.h"
#include "results.h"

#include "filasofia/core/error.h"
#include "filasofia/core/word.h"
#include "filasofia/scene/import.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace filasofia::python {

Session& usable(HeldSimulation& held, const char* what)
{
    held.session->requireUsable(what);
    return *held.session;
}

namespace {

using physics::RigidBodyDef;
using physics::SoftBodyDef;

/// Runs `act` for a scene file. Its fields keep their names in errors: they are not those of Python.
template <class Act> auto ofSceneFile(Act&& act)
{
    try {
        return act();
    } catch (const Error& error) {
        throw PythonError(error.what());
    }
}

void make(HeldSimulation* self, nb::handle physics, nb::handle look, nb::handle file, bool anyFolder,
          nb::handle threads, bool strict, nb::handle package, nb::handle unit, nb::handle measures, nb::handle sensors)
{
    runtime::SimulationDef def;
    scene::SceneDef scene;
    if (!file.is_none()) {
        const std::string name = readText(file, {.name = "load: file"});
        scene::ImportOptions options{.anyFolder = anyFolder, .strict = strict};
        if (!package.is_none()) options.packages = {readText(package, {.name = "load: package"})};
        if (!unit.is_none()) options.unit = readArgument<double>(unit, "load", "unit", positive());
        scene = ofSceneFile([&] { return scene::loadAnyScene(name, options); });
        def = scene::simulationDef(scene);
        if (!threads.is_none())
            def.physics.threads =
                readArgument<int>(threads, "load", "threads", boundOf(&runtime::PhysicsDef::threads).range);
    }
    const char* const call = file.is_none() ? "Simulation" : "load";
    if (!physics.is_none()) def.physics = readDef<runtime::PhysicsDef>(physics, text(call, ": physics"));
    if (!look.is_none()) def.look = readDef<runtime::LookDef>(look, text(call, ": look"));
    const std::string written = measures.is_none() ? "" : readText(measures, {.name = "load: measures"});
    if (!measures.is_none() && written.empty()) fail("load: measures must name a .jsonl or .csv file, got ''");
    const std::string table = sensors.is_none() ? "" : readText(sensors, {.name = "load: sensors"});
    if (!sensors.is_none() && table.empty()) fail("load: sensors must name a .csv file, got ''");
    std::shared_ptr<Session> session;
    {
        const nb::gil_scoped_release free;
        session = Session::make(def);
        ofSceneFile([&] { session->add(scene, {.file = written}, table); });
    }
    new (self) HeldSimulation{.session = std::move(session)};
    self->shownByScene = self->session->drawn();
    const auto drawn = [](const scene::SceneKnot& each) { // its driver
        return std::holds_alternative<prefab::InstrumentTieDef>(each.def);
    };
    self->shown = !scene.instruments.empty() || std::ranges::any_of(scene.knots, drawn) ||
                  std::ranges::any_of(scene.bodies, [](const scene::SceneBody& each) { return !each.show.empty(); });
}

/// "soft body 'liver'", as the engine's own errors begin.
std::string objectOf(const char* kind, nb::handle def)
{
    const nb::object name = def.attr("name");
    return nb::isinstance<nb::str>(name) ? text(kind, " '", nb::cast<std::string>(name), "'") : std::string(kind);
}

/// Adds the body if the object is one of this kind of Def.
template <class Def> std::optional<BodyId> addAs(const char* kind, nb::handle def, Session& session)
{
    if (!Convert<Def>::takes(def)) return std::nullopt;
    auto read = readDef<Def>(def, objectOf(kind, def));
    const nb::gil_scoped_release free;
    return session.simulation().add(std::move(read));
}

nb::object add(HeldSimulation& self, nb::handle def)
{
    Session& session = usable(self, "add");
    std::optional<BodyId> id = addAs<SoftBodyDef>("soft body", def, session);
    if (!id) id = addAs<RigidBodyDef>("rigid body", def, session);
    if (!id) id = addAs<physics::RodBodyDef>("rod", def, session);
    if (!id) failType({.name = "add: the body"}, "must be a SoftBodyDef, a RigidBodyDef or a RodBodyDef", def);
    return Convert<BodyId>::make(*id);
}

nb::object definition(HeldSimulation& self, nb::handle body)
{
    const auto def = usable(self, "definition").physics().def(readArgument<BodyId>(body, "definition", "body"));
    return std::visit([](const auto& each) { return Convert<std::remove_cvref_t<decltype(each)>>::make(each); }, *def);
}

void record(HeldSimulation& self, nb::handle file, nb::handle log, int seed, const std::string& session)
{
    const runtime::RunDef def{.log = readArgument<std::string>(log, "record", "log"),
                              .record = readArgument<std::string>(file, "record", "file"),
                              .seed = seed,
                              .session = session};
    if (def.record.empty() && def.log.empty()) fail("record: must have a file (.rec) or a log (.csv), got neither");
    const Session::Turn turn(*self.session, "record");
    self.session->record(def);
}

runtime::RunReport report(HeldSimulation& self)
{
    if (self.session->closed()) return self.session->report();
    const Session::Turn turn(*self.session, "report", Session::Turn::Of::OpenOrClosed);
    return self.session->report();
}

runtime::RunReport runFor(HeldSimulation& self, double seconds)
{
    if (!(seconds > 0.0) || seconds > 1e8) fail("run: seconds must be in (0, 1e8], got ", seconds);
    const Session::Turn turn(*self.session, "run"); // also for the report: nobody may step in between
    const double wanted = seconds / self.session->period() + self.owed;
    const double steps = std::max(0.0, std::round(wanted));
    self.owed = wanted - steps;
    if (steps > 0.0) makeSteps(self, static_cast<std::uint64_t>(steps), "run");
    return self.session->report();
}

std::uint64_t hashOf(HeldSimulation& self)
{
    if (self.session->closed()) return self.session->hash();
    const Session::Turn turn(*self.session, "state_hash", Session::Turn::Of::OpenOrClosed);
    return self.session->hash();
}

physics::MechanicalEnergy energyOf(HeldSimulation& self, nb::handle body)
{
    const auto id = readArgument<BodyId>(body, "mechanical_energy", "body");
    const Session::Turn turn(*self.session, "mechanical_energy");
    return self.session->physics().mechanicalEnergy(id);
}

void noteScripts(HeldSimulation& self)
{
    self.scripted =
        std::ranges::find(self.observers, Observer::kEveryStep, &Observer::alternative) != self.observers.end();
}

std::uint64_t observe(HeldSimulation& self, std::size_t alternative, nb::object callback, const char* what)
{
    usable(self, what);
    if (!PyCallable_Check(callback.ptr())) failType({.name = what}, "needs a function to call", callback);
    if (alternative != Observer::kEveryStep) self.session->collect(alternative, true);
    self.observers.push_back({++self.lastObserver, alternative, std::move(callback)});
    noteScripts(self);
    return self.lastObserver;
}

void endObserver(HeldSimulation& self, std::uint64_t observer)
{
    auto& all = self.observers;
    const auto found = std::ranges::find(all, observer, &Observer::id);
    if (found == all.end()) fail("off: there is no observer ", observer);
    const Observer gone = std::move(*found); // freed after the list is whole again
    all.erase(found);
    noteScripts(self);
    const bool every = gone.alternative == Observer::kEveryStep;
    if (every || std::ranges::find(all, gone.alternative, &Observer::alternative) != all.end()) return;
    self.session->collect(gone.alternative, false); // nobody listens: what happens need not become objects
}

void close(HeldSimulation& self)
{
    if (self.session->closed()) return;
    const Session::Turn turn(*self.session, "close", Session::Turn::Of::OpenOrClosed);
    const nb::gil_scoped_release free;
    self.session->close();
}

// The garbage collector must see the callbacks: they often hold the simulation.
int traverse(PyObject* self, visitproc visit, void* arg)
{
    Py_VISIT(Py_TYPE(self));
    if (!nb::inst_ready(self)) return 0;
    for (const Observer& each : nb::inst_ptr<HeldSimulation>(self)->observers) Py_VISIT(each.call.ptr());
    return 0;
}
int clear(PyObject* self)
{
    if (!nb::inst_ready(self)) return 0;
    const auto observers = std::exchange(nb::inst_ptr<HeldSimulation>(self)->observers, {});
    return 0; // freed here, after the list is empty
}
PyType_Slot slots[] = {
    {Py_tp_traverse, reinterpret_cast<void*>(traverse)}, {Py_tp_clear, reinterpret_cast<void*>(clear)}, {0, nullptr}};

void addBodies(nb::class_<HeldSimulation>& sim)
{
    sim.def("add", &add, nb::arg("body").none(),
            nb::sig("def add(self, body: filasofia.SoftBodyDef | filasofia.RigidBodyDef | filasofia.RodBodyDef) -> "
                    "filasofia.BodyId"),
            "Adds a body; it is there from the next step on.");
    sim.def(
        "remove",
        [](HeldSimulation& self, nb::handle body) {
            usable(self, "remove").physics().remove(readArgument<BodyId>(body, "remove", "body"));
        },
        nb::arg("body").none(), nb::sig("def remove(self, body: filasofia.BodyId) -> None"));
    sim.def("definition", &definition, nb::arg("body").none(),
            nb::sig("def definition(self, body: filasofia.BodyId) -> typing.Any"),
            "A copy of the SoftBodyDef, RigidBodyDef or RodBodyDef that a body was made from, with its meshes.");
    sim.def_prop_ro(
        "bodies",
        [](HeldSimulation& self) {
            return Convert<std::vector<BodyId>>::make(usable(self, "bodies").physics().bodies());
        },
        nb::for_getter(nb::sig("def bodies(self) -> list[filasofia.BodyId]")),
        "The bodies that were added and not removed.");
}

/// Where a kinematic body is in the newest frame; before its first step, where it starts.
Pose placeOf(Session& session, BodyId body, const Where& where, nb::handle key)
{
    const auto def = session.physics().def(body);
    const auto* rigid = std::get_if<RigidBodyDef>(&*def);
    if (!rigid || rigid->dynamic) failValue(where, "must have kinematic bodies as keys", key);
    const auto frame = session.physics().latest();
    if ((frame ? frame->step : 0) != session.steps()) fail("step: moves need the newest frame: let go of older ones");
    const frame::RigidBodyFrame* seen = frame ? frame->rigidBody(body) : nullptr;
    return seen ? seen->poses.front() : rigid->elements.front();
}

std::vector<Move> readMoves(Session& session, nb::handle moves)
{
    std::vector<Move> read;
    if (moves.is_none()) return read;
    const Where where{.name = "step: moves"};
    if (!nb::isinstance<nb::dict>(moves)) failType(where, "must be a dict of poses by bodies", moves);
    for (const auto [key, value] : nb::borrow<nb::dict>(moves)) {
        const auto body = readArgument<BodyId>(key, "step", "the key of moves");
        const auto to =
            physics::unitPose(readArgument<Pose>(value, "step", "a pose of moves"), "step: a pose of moves");
        read.push_back({body, 0, placeOf(session, body, where, key), to});
    }
    return read;
}

void addSteps(nb::class_<HeldSimulation>& sim)
{
    sim.def(
        "step",
        [](HeldSimulation& self, std::int64_t n, nb::handle moves) {
            if (n < 1) fail("step: n must be >= 1, got ", n);
            const Session::Turn turn(*self.session, "step");
            return makeSteps(self, static_cast<std::uint64_t>(n), "step", readMoves(*self.session, moves));
        },
        nb::arg("n") = 1, nb::arg("moves") = nb::none(),
        nb::sig("def step(self, n: int = 1, moves: dict[filasofia.BodyId, filasofia.Pose | "
                "collections.abc.Sequence[float]] | None = None) -> StepReport"),
        "Makes n steps and returns the report of the last one. Other threads of Python run meanwhile.\n\n"
        "`moves` gives kinematic bodies the poses [m] that their first elements reach with the last step: straight, at "
        "constant speed, from where they are in the newest frame, or start. A position alone means no rotation.");
    sim.def("run", &runFor, nb::arg("seconds"),
            "Makes the steps of this simulated time [s]; returns the report of the run.\n\n"
            "Steps are whole: what rounding leaves of one is made up for by the next call, so that 60 calls of run(1 / "
            "60) make a second at any rate. A call of less than half a step may make none. step(n) says exactly how "
            "many.");
    sim.def_prop_ro(
        "dt", [](HeldSimulation& self) { return self.session->period(); }, "[s] of one step");
    sim.def_prop_ro(
        "time", [](HeldSimulation& self) { return self.session->time(); }, "[s], simulated");
    sim.def_prop_ro(
        "steps", [](HeldSimulation& self) { return self.session->steps(); }, "Number of steps completed.");
    sim.def_prop_ro(
        "frame",
        [](HeldSimulation& self) {
            self.session->requireUsable("frame");
            return newestFrame(self.session);
        },
        "The state after the last step, without a copy.");
}

void addRecords(nb::class_<HeldSimulation>& sim)
{
    sim.def_prop_ro("state_hash", &hashOf,
                    "A hash of the state: the same scene gives the same one at every step. After close() it is that of "
                    "the last state.");
    sim.def("mechanical_energy", &energyOf, nb::arg("body").none(),
            nb::sig("def mechanical_energy(self, body: filasofia.BodyId) -> filasofia.MechanicalEnergy"),
            "The mechanical energy [J] of a body after the last step, computed when it is asked for. What relaxing "
            "terms of tissue, attachments, contacts and pressures store is not in it.");
    sim.def("report", &report,
            "How the run went until now. Before the first step all its numbers but the hash are 0; to ask for it does "
            "not begin the run.");
    sim.def(
        "record", &record, nb::arg("file").none() = "", nb::arg("log").none() = "", nb::arg("seed") = 0,
        nb::arg("session") = "",
        nb::sig("def record(self, file: str | os.PathLike[str] = '', log: str | os.PathLike[str] = '', seed: int = 0, "
                "session: str = '') -> None"),
        "Writes the run into a .rec file, for replay(), and a line per step into a .csv file. Before the first step. "
        "If it is refused, the simulation is as before.");
    sim.def("close", &close,
            "Ends the run and closes its files. Frames, report(), state_hash and the times stay; everything else is an "
            "Error from now on.");
    sim.def_prop_ro("_foreign", [](HeldSimulation& self) { return self.session->foreign(); });
    sim.def(
        "__enter__", [](nb::handle self) { return nb::borrow(self); },
        nb::sig("def __enter__(self) -> typing_extensions.Self"));
    sim.def(
        "__exit__", [](HeldSimulation& self, nb::args) { close(self); },
        nb::sig("def __exit__(self, *args: object) -> None"));
}

void addCallbacks(nb::class_<HeldSimulation>& sim)
{
    sim.def(
        "on",
        [](HeldSimulation& self, nb::handle event, nb::object callback) {
            return observe(self, alternativeOf(event), std::move(callback), "on");
        },
        nb::arg("event").none(), nb::arg("callback").none(),
        nb::sig("def on(self, event: type, callback: collections.abc.Callable[[typing.Any], object]) -> int"),
        "Calls back for every event of a class (ContactEvent, CutEvent, ...) after the step in which it happened. "
        "Returns a number for off(). A list collects them: sim.on(ContactEvent, touches.append).");
    sim.def(
        "every_step",
        [](HeldSimulation& self, nb::object callback) {
            return observe(self, Observer::kEveryStep, std::move(callback), "every_step");
        },
        nb::arg("callback").none(),
        nb::sig("def every_step(self, callback: collections.abc.Callable[[float], object]) -> int"),
        "Calls back before every step with the simulated time [s] at its end. Returns a number for off().");
    sim.def("off", &endObserver, nb::arg("observer"), "Ends a callback.");
}

} // namespace

void bindSimulation(nb::module_& module)
{
    nb::class_<HeldSimulation> sim(module, "Simulation", nb::type_slots(slots), nb::is_weak_referenceable());
    sim.def("__init__", &make, nb::arg("physics") = nb::none(), nb::arg("look") = nb::none(),
            nb::arg("scene") = nb::none(), nb::arg("any_folder") = false, nb::arg("threads") = nb::none(),
            nb::arg("strict") = false, nb::arg("package") = nb::none(), nb::arg("unit") = nb::none(),
            nb::arg("measures") = nb::none(), nb::arg("sensors") = nb::none());
    addBodies(sim);
    addSteps(sim);
    addStates(module, sim);
    addMeasures(module, sim);
    addTasks(module, sim);
    addSensors(sim);
    addRecords(sim);
    addCallbacks(sim);
    addPictures(sim);
    addCommands(sim);
}

} // namespace filasofia::python
