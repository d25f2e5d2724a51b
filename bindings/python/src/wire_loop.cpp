#include "arrays.h"
#include "held_prefab.h"
#include "results.h"

#include "filasofia/prefab/wire_loop.h"

namespace filasofia::python {
namespace {

using HeldLoop = HeldPrefab<prefab::WireLoop>;

void make(HeldLoop* self, HeldSimulation& sim, nb::handle def)
{
    hold(self, sim, "WireLoop",
         def.is_none() ? prefab::WireLoopDef{} : readDef<prefab::WireLoopDef>(def, "WireLoop: definition"));
    drawBeside(*self, sim, false);
}

/// A new array of the points.
nb::object lineOf(const prefab::WireLoop& loop)
{
    std::vector<double> numbers;
    for (const Vec3& each : loop.line()) numbers.insert(numbers.end(), {each.x, each.y, each.z});
    return arrayOf(std::move(numbers), {loop.line().size(), 3});
}

void addPedals(nb::class_<HeldLoop>& loop)
{
    loop.def(
            "cut", [](HeldLoop& self, nb::handle on) { self.open("cut").cut(readArgument<bool>(on, "cut", "on")); },
            nb::arg("on").none(), nb::sig("def cut(self, on: bool) -> None"),
            "Presses the yellow pedal, or releases it: electrode CUTS of its body.")
        .def(
            "dry", [](HeldLoop& self, nb::handle on) { self.open("dry").dry(readArgument<bool>(on, "dry", "on")); },
            nb::arg("on").none(), nb::sig("def dry(self, on: bool) -> None"),
            "Presses the blue pedal, which coagulates, or releases it: electrode DRIES.");
    loop.attr("CUTS") = prefab::WireLoop::kCuts;
    loop.attr("DRIES") = prefab::WireLoop::kDries;
}

} // namespace

void addWireLoop(nb::module_& module)
{
    nb::class_<HeldLoop> loop(module, "WireLoop",
                              "The loop of a resectoscope, which cuts with current and shaves chips off tissue. It is "
                              "drawn.");
    loop.def("__init__", &make, nb::arg("sim"), nb::arg("definition").none() = nb::none(),
             nb::sig("def __init__(self, sim: filasofia.Simulation, definition: filasofia.WireLoopDef | None = None) "
                     "-> None"),
             "Adds its body, a kinematic rigid one with two electrodes.")
        .def(
            "move",
            [](HeldLoop& self, nb::handle pose) { self.open("move").move(readArgument<Pose>(pose, "move", "pose")); },
            nb::arg("pose").none(),
            nb::sig("def move(self, pose: filasofia.Pose | collections.abc.Sequence[float]) -> None"),
            "Its pose at the end of the next step; the arms lie along its +z, and the U hangs towards -y.")
        .def_prop_ro(
            "body", [](const HeldLoop& self) { return Convert<BodyId>::make(self.open("body").body()); },
            nb::for_getter(nb::sig("def body(self) -> filasofia.BodyId")), "its rigid body")
        .def_prop_ro(
            "definition",
            [](const HeldLoop& self) { return Convert<prefab::WireLoopDef>::make(self.open("definition").def()); },
            nb::for_getter(nb::sig("def definition(self) -> filasofia.WireLoopDef")), "a copy of what it was made from")
        .def_prop_ro(
            "line", [](const HeldLoop& self) { return lineOf(self.open("line")); },
            nb::for_getter(nb::sig("def line(self) -> numpy.typing.NDArray[numpy.float64]")),
            "(n, 3) [m], along the middle of the wire from arm to arm, in its own coordinates")
        .def_prop_ro(
            "pose", [](const HeldLoop& self) { return Convert<Pose>::make(self.open("pose").pose()); },
            nb::for_getter(nb::sig("def pose(self) -> filasofia.Pose")), "the last pose given to move()");
    addPedals(loop);
}

} // namespace filasofia::python
