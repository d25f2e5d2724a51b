#include "instrument.h"

#include "arrays.h"
#include "results.h"

#include "filasofia/core/error.h"

namespace filasofia::python {
namespace {

void make(HeldInstrument* self, HeldSimulation& sim, nb::handle given)
{
    auto def = given.is_none() ? prefab::ArticulatedInstrumentDef{}
                               : readDef<prefab::ArticulatedInstrumentDef>(given, "ArticulatedInstrument: definition");
    hold(self, sim, "ArticulatedInstrument", def);
    drawBeside(*self, sim, true);
}

void close(HeldInstrument& self, nb::handle torque)
{
    self.open("close").close(readArgument<std::optional<double>>(torque, "close", "torque", positive()));
}

void addMotions(nb::class_<HeldInstrument>& instrument)
{
    instrument
        .def(
            "move",
            [](HeldInstrument& self, nb::handle pose) {
                self.open("move").move(readArgument<Pose>(pose, "move", "pose"));
            },
            nb::arg("pose").none(),
            nb::sig("def move(self, pose: filasofia.Pose | collections.abc.Sequence[float]) -> None"),
            "The pose of its pivot at the end of the next step; its shaft points along -z.")
        .def(
            "open",
            [](HeldInstrument& self, nb::handle opening) {
                self.open("open").open(readArgument<double>(opening, "open", "opening", closed(0, 1)));
            },
            nb::arg("opening").none() = 1.0, nb::sig("def open(self, opening: float = 1.0) -> None"),
            "Moves the jaws to this fraction of their opening angle, and releases what they hold.")
        .def("close", &close, nb::arg("torque").none() = nb::none(),
             nb::sig("def close(self, torque: float | None = None) -> None"),
             "Presses the jaws together, each with `torque` [N m]; without it with that of the definition. What both "
             "sides then press is grasped.")
        .def(
            "carries",
            [](HeldInstrument& self, nb::handle at) {
                self.open("carries").carries(readArgument<Vec3>(at, "carries", "at"));
            },
            nb::arg("at").none(), nb::sig("def carries(self, at: collections.abc.Sequence[float]) -> None"),
            "Something is fixed to it for good, and pulls at this point [m] in the coordinates of the pivot.");
}

void addReadings(nb::class_<HeldInstrument>& instrument)
{
    instrument
        .def_prop_ro(
            "body", [](const HeldInstrument& self) { return Convert<BodyId>::make(self.open("body").body()); },
            nb::for_getter(nb::sig("def body(self) -> filasofia.BodyId")),
            "its rigid body: element 0 is the shaft, moving jaws follow")
        .def_prop_ro(
            "pose", [](const HeldInstrument& self) { return Convert<Pose>::make(self.open("pose").pose()); },
            nb::for_getter(nb::sig("def pose(self) -> filasofia.Pose")), "the last pose given to move()")
        .def_prop_ro(
            "holding", [](const HeldInstrument& self) { return Convert<BodyId>::make(self.open("holding").holding()); },
            nb::for_getter(nb::sig("def holding(self) -> filasofia.BodyId | None")), "the body that it holds")
        .def_prop_ro(
            "pull", [](const HeldInstrument& self) { return self.open("pull").pull(); },
            "[N], force of what it holds on it in the last step")
        .def_prop_ro(
            "grip", [](const HeldInstrument& self) { return vectorOf(self.open("grip").grip()); },
            nb::for_getter(nb::sig("def grip(self) -> numpy.typing.NDArray[numpy.float64]")),
            "(3,) [m], where that pulls, in the world; its pivot if it holds nothing")
        .def_prop_ro(
            "opening", [](const HeldInstrument& self) { return self.open("opening").opening(); },
            "[-], of the widest jaw in the last step; without jaws 0 if it was told to close, and 1 if not")
        .def_prop_ro(
            "kind",
            [](const HeldInstrument& self) { return Convert<prefab::InstrumentKind>::make(self.open("kind").kind()); },
            nb::for_getter(nb::sig("def kind(self) -> str")), "the word of its definition");
}

} // namespace

prefab::ArticulatedInstrument* asInstrument(nb::handle tool, const HeldSimulation& sim, const char* constructor)
{
    if (!nb::isinstance<HeldInstrument>(tool)) return nullptr;
    const auto& held = nb::cast<const HeldInstrument&>(tool);
    if (held.session != sim.session) fail(constructor, ": the tool must be an instrument of the same simulation");
    return held.prefab.get();
}

prefab::ArticulatedInstrument& readInstrument(nb::handle tool, const HeldSimulation& sim, const char* constructor)
{
    if (auto* found = asInstrument(tool, sim, constructor)) return *found;
    const Where object{.name = constructor};
    failType({.outer = &object, .name = "tool"}, "must be an ArticulatedInstrument", tool);
}

void addInstrument(nb::module_& module)
{
    nb::class_<HeldInstrument> instrument(
        module, "ArticulatedInstrument",
        "A shaft with jaws, a hook or a tube, which is moved as a whole, opened and closed. It is drawn. Keep it: "
        "nothing else moves its body. A reset does not release what it holds: call open() before.");
    instrument.def("__init__", &make, nb::arg("sim"), nb::arg("definition").none() = nb::none(),
                   nb::sig("def __init__(self, sim: filasofia.Simulation, definition: "
                           "filasofia.ArticulatedInstrumentDef | None = None) -> None"),
                   "Adds its body.");
    instrument.attr("SHAFT") = prefab::ArticulatedInstrument::kShaft;
    addMotions(instrument);
    addReadings(instrument);
}

} // namespace filasofia::python
