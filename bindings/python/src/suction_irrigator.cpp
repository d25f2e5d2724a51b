#include "instrument.h"
#include "results.h"

#include "filasofia/prefab/suction_irrigator.h"

namespace filasofia::python {
namespace {

using HeldSuction = HeldPrefab<prefab::SuctionIrrigator>;

void make(HeldSuction* self, HeldSimulation& sim, nb::handle tool, nb::handle def)
{
    auto& instrument = readInstrument(tool, sim, "SuctionIrrigator");
    hold(self, sim, "SuctionIrrigator", instrument,
         def.is_none() ? prefab::SuctionIrrigatorDef{}
                       : readDef<prefab::SuctionIrrigatorDef>(def, "SuctionIrrigator: definition"));
}

} // namespace

void addSuctionIrrigator(nb::module_& module)
{
    nb::class_<HeldSuction>(module, "SuctionIrrigator",
                            "A tube that sucks blood and smoke away while its tool is closed, and rinses.")
        .def("__init__", &make, nb::arg("sim"), nb::arg("tool").none(), nb::arg("definition").none() = nb::none(),
             nb::sig("def __init__(self, sim: filasofia.Simulation, tool: filasofia.ArticulatedInstrument, definition: "
                     "filasofia.SuctionIrrigatorDef | None = None) -> None"),
             "The tool is an instrument of any kind, such as 'suctionIrrigator'.")
        .def(
            "rinse",
            [](HeldSuction& self, nb::handle on) { self.open("rinse").rinse(readArgument<bool>(on, "rinse", "on")); },
            nb::arg("on").none(), nb::sig("def rinse(self, on: bool) -> None"),
            "Opens or shuts the valve of the liquid, from the next step on.")
        .def_prop_ro(
            "rinses", [](const HeldSuction& self) { return self.open("rinses").rinses(); },
            "whether liquid flows, as of the last step")
        .def_prop_ro(
            "sucks", [](const HeldSuction& self) { return self.open("sucks").sucks(); },
            "whether its tool is closed, as of the last step")
        .def_prop_ro(
            "irrigated", [](const HeldSuction& self) { return self.open("irrigated").irrigated(); },
            "[m^3], of liquid that has flowed");
}

} // namespace filasofia::python
