#include "instrument.h"
#include "results.h"

#include "filasofia/prefab/ultrasonic_shears.h"

namespace filasofia::python {
namespace {

using HeldShears = HeldPrefab<prefab::UltrasonicShears>;

void make(HeldShears* self, HeldSimulation& sim, nb::handle tool, nb::handle def)
{
    auto& instrument = readInstrument(tool, sim, "UltrasonicShears");
    hold(self, sim, "UltrasonicShears", instrument,
         def.is_none() ? prefab::UltrasonicShearsDef{}
                       : readDef<prefab::UltrasonicShearsDef>(def, "UltrasonicShears: definition"));
}

} // namespace

void addUltrasonicShears(nb::module_& module)
{
    nb::class_<HeldShears> shears(module, "UltrasonicShears",
                                  "Jaws that heat what they hold while a pedal is pressed, and part it when it is "
                                  "sealed. Tissue must burn (burn()) and have dynamic_topology.");
    shears
        .def("__init__", &make, nb::arg("sim"), nb::arg("tool").none(), nb::arg("definition").none() = nb::none(),
             nb::sig("def __init__(self, sim: filasofia.Simulation, tool: filasofia.ArticulatedInstrument, definition: "
                     "filasofia.UltrasonicShearsDef | None = None) -> None"),
             "The tool is an instrument with one jaw that moves and without electrode, such as one of kind "
             "'ultrasonicShears'.")
        .def(
            "press",
            [](HeldShears& self, nb::handle on) { self.open("press").press(readArgument<bool>(on, "press", "on")); },
            nb::arg("on").none(), nb::sig("def press(self, on: bool) -> None"),
            "Presses the pedal, or releases it: activate() of the tool's electrode PEDAL.")
        .def_prop_ro(
            "sealed", [](const HeldShears& self) { return self.open("sealed").sealed(); },
            "[-], share of the heated nodes between the jaws that are burnt, when the pedal was last pressed")
        .def_prop_ro(
            "parts", [](const HeldShears& self) { return self.open("parts").parts(); }, "whether tissue is parting now")
        .def_prop_ro(
            "parted", [](const HeldShears& self) { return self.open("parted").parted(); },
            "[-], how often it has parted up to the tip");
    shears.attr("PEDAL") = prefab::UltrasonicShears::kPedal;
}

} // namespace filasofia::python
