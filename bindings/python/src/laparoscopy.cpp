// What goes through a trocar: instruments and a scope, and the hands that a person moves them with.
#include "instrument.h"
#include "properties.h"
#include "results.h"
#include "scope.h"

#include "filasofia/prefab/trocar_hands.h"

namespace filasofia::python {
namespace {

using prefab::TrocarPose;
using prefab::TrocarReport;
using HeldLaparoscopic = HeldPrefab<prefab::LaparoscopicInstrument>;
using HeldScope = HeldPrefab<prefab::Laparoscope>;
using HeldHands = HeldPrefab<prefab::TrocarHands>;

void makeInstrument(HeldLaparoscopic* self, HeldSimulation& sim, nb::handle given)
{
    hold(self, sim, "LaparoscopicInstrument",
         given.is_none() ? prefab::LaparoscopicInstrumentDef{}
                         : readDef<prefab::LaparoscopicInstrumentDef>(given, "LaparoscopicInstrument: definition"));
    drawBeside(*self, sim, true);
}

/// What an instrument and a scope have in common. `def`: the name of its Def.
template <class Prefab> void addTrocar(nb::class_<HeldPrefab<Prefab>>& bound, const char* def)
{
    using Held = HeldPrefab<Prefab>;
    bound
        .def(
            "move",
            [](Held& self, nb::handle pose) { self.open("move").move(readArgument<TrocarPose>(pose, "move", "pose")); },
            nb::arg("pose").none(), nb::sig("def move(self, pose: filasofia.TrocarPose) -> None"),
            "Where the hand wants it; it goes there at 0.25 m/s at most if the hand has a finite strength. Error "
            "outside the limits of the trocar.")
        .def(
            "pose_at",
            [](Held& self, nb::handle target, nb::handle roll, nb::handle point) {
                const prefab::TrocarDef& trocar = self.open("pose_at").def().trocar;
                return Convert<TrocarPose>::make(
                    withinLimits(trocar, poseAt(trocar, readArgument<Vec3>(target, "pose_at", "target"),
                                                readArgument<double>(roll, "pose_at", "roll"),
                                                readArgument<Vec3>(point, "pose_at", "point"))));
            },
            nb::arg("target").none(), nb::arg("roll").none() = 0.0, nb::arg("point").none() = nb::make_tuple(0, 0, 0),
            nb::sig("def pose_at(self, target: collections.abc.Sequence[float], roll: float = 0.0, point: "
                    "collections.abc.Sequence[float] = (0, 0, 0)) -> filasofia.TrocarPose"),
            "The pose with this roll [rad] that brings a point [m], in the coordinates of the pivot or of a scope's "
            "tip, to a target in the world [m] while the wall does not yield; within the limits of the trocar.")
        .def_prop_ro(
            "report", [](Held& self) { return self.open("report").report(); }, "as the last step left it")
        .def_prop_ro(
            "definition",
            [](Held& self) {
                const auto& from = self.open("definition").def();
                return Convert<std::remove_cvref_t<decltype(from)>>::make(from);
            },
            nb::for_getter(nb::sig(text("def definition(self) -> filasofia.", def).c_str())), "a copy")
        .def_prop_ro(
            "body", [](Held& self) { return Convert<BodyId>::make(self.open("body").body()); },
            nb::for_getter(nb::sig("def body(self) -> filasofia.BodyId")), "its rigid body");
}

void addReport(nb::module_& module)
{
    nb::class_<TrocarReport> report(module, "TrocarReport", "What a hand at the handle feels, and where the shaft is.");
    report
        .def_prop_ro(
            "pose", [](const TrocarReport& self) { return Convert<TrocarPose>::make(self.pose); },
            nb::for_getter(nb::sig("def pose(self) -> filasofia.TrocarPose")),
            "that the hand has given, as far as strength and speed let it")
        .def_prop_ro(
            "pivot", [](const TrocarReport& self) { return Convert<Pose>::make(self.pivot); },
            nb::for_getter(nb::sig("def pivot(self) -> filasofia.Pose")), "of the jaws, or a scope's tip, in the world")
        .def_ro("torque", &TrocarReport::torque, "[N m], on the hand, about the shaft's direction");
    addVector(report, "handle", &TrocarReport::handle, "(3,) [m], where the hand holds the shaft, in the world");
    addVector(report, "shift", &TrocarReport::shift, "(3,) [m], how far the wall has yielded at the fulcrum");
    addVector(report, "force", &TrocarReport::force, "(3,) [N], on the hand: tissue by the lever, wall and seal");
    addVector(report, "wall", &TrocarReport::wall, "(3,) [N], from the wall on the shaft, sideways");
}

void addScope(nb::module_& module)
{
    nb::class_<HeldScope> scope(module, "Laparoscope",
                                "A rigid scope through a trocar. Pictures and the viewer show what it sees, unless "
                                "they are told another pose. Make it before the first step.");
    scope.def(
        "__init__",
        [](HeldScope* self, HeldSimulation& sim, nb::handle given) {
            makeScope<prefab::Laparoscope, prefab::LaparoscopeDef>(self, sim, given, "Laparoscope");
        },
        nb::arg("sim"), nb::arg("definition").none() = nb::none(),
        nb::sig("def __init__(self, sim: filasofia.Simulation, definition: filasofia.LaparoscopeDef | None = "
                "None) -> None"),
        "Adds its body.");
    addTrocar(scope, "LaparoscopeDef");
    addLens(scope);
    scope
        .def(
            "zoom",
            [](HeldScope& self, nb::handle times) {
                self.open("zoom").zoom(readArgument<double>(times, "zoom", "times", closed(1, 4)));
            },
            nb::arg("times").none(), nb::sig("def zoom(self, times: float) -> None"),
            "[-], in [1, 4], how much larger the picture's middle is than without zoom: in the next picture, and in "
            "depth images after it.")
        .def(
            "horizon",
            [](HeldScope& self, nb::handle keep) {
                self.open("horizon").horizon(readArgument<bool>(keep, "horizon", "keep"));
            },
            nb::arg("keep").none(), nb::sig("def horizon(self, keep: bool) -> None"),
            "Whether the camera head keeps the picture upright.")
        .def_prop_ro(
            "field_of_view", [](HeldScope& self) { return self.open("field_of_view").fieldOfView(); },
            "[rad], over the height of the picture, with the present zoom");
}

void makeHands(HeldHands* self, HeldSimulation& sim, HeldLaparoscopic& left, HeldLaparoscopic& right, HeldScope& scope,
               nb::handle given)
{
    for (const std::shared_ptr<Session>& each : {left.session, right.session, scope.session})
        if (each != sim.session) fail("TrocarHands: an instrument or the scope is of another simulation");
    if (usable(sim, "TrocarHands").begun()) fail("TrocarHands: the run has begun: make them before the first step");
    if (left.prefab == right.prefab) fail("TrocarHands: left and right must be two instruments, and are one");
    hold(self, sim, "TrocarHands", *left.prefab, *right.prefab, *scope.prefab,
         given.is_none() ? prefab::TrocarHandsDef{}
                         : readDef<prefab::TrocarHandsDef>(given, "TrocarHands: definition"));
    sim.session->keep(self->prefab);
}

void addHands(nb::module_& module)
{
    nb::class_<HeldHands>(module, "TrocarHands",
                          "A person at a viewer moves two instruments and a scope with mouse and keys: 1, 2 and 3 "
                          "choose one, a right drag turns its shaft, the wheel moves it in and out, the left button "
                          "closes its jaws. move() of these does not last meanwhile.")
        .def("__init__", &makeHands, nb::arg("sim"), nb::arg("left"), nb::arg("right"), nb::arg("scope"),
             nb::arg("definition").none() = nb::none(),
             nb::sig("def __init__(self, sim: filasofia.Simulation, left: filasofia.LaparoscopicInstrument, right: "
                     "filasofia.LaparoscopicInstrument, scope: filasofia.Laparoscope, definition: "
                     "filasofia.TrocarHandsDef | None = None) -> None"),
             "Make them before the first step. They hold these until the simulation ends; no state can be restored.")
        .def_prop_ro(
            "wanted",
            [](HeldHands& self) {
                const prefab::TrocarPoses poses = self.open("wanted").wanted();
                return nb::make_tuple(Convert<TrocarPose>::make(poses.left), Convert<TrocarPose>::make(poses.right),
                                      Convert<TrocarPose>::make(poses.scope));
            },
            nb::for_getter(nb::sig("def wanted(self) -> tuple[filasofia.TrocarPose, filasofia.TrocarPose, "
                                   "filasofia.TrocarPose]")),
            "where the left and the right instrument and the scope were told to be, in the last step");
}

} // namespace

void addLaparoscopy(nb::module_& module)
{
    addReport(module);
    nb::class_<HeldLaparoscopic> instrument(
        module, "LaparoscopicInstrument",
        "An instrument whose shaft goes through a trocar: the tip goes the other way than the hand, which feels forces "
        "on the tip by the law of the lever. It is drawn.");
    instrument.def("__init__", &makeInstrument, nb::arg("sim"), nb::arg("definition").none() = nb::none(),
                   nb::sig("def __init__(self, sim: filasofia.Simulation, definition: "
                           "filasofia.LaparoscopicInstrumentDef | None = None) -> None"),
                   "Adds its body.");
    addTrocar(instrument, "LaparoscopicInstrumentDef");
    instrument.def_prop_ro(
        "tool",
        [](HeldLaparoscopic& self) {
            return HeldInstrument{self.session, {self.prefab, &self.open("tool").tool()}};
        },
        nb::for_getter(nb::sig("def tool(self) -> filasofia.ArticulatedInstrument")),
        "its jaws, to open and close, and to mount something on; what it is told by move() does not last");
    addScope(module);
    addHands(module);
}

} // namespace filasofia::python
