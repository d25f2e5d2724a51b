#include "held_prefab.h"
#include "results.h"

#include "filasofia/prefab/instrument_tie.h"

namespace filasofia::python {
namespace {

using HeldTie = HeldPrefab<prefab::InstrumentTie>;

void make(HeldTie* self, HeldSimulation& sim, nb::handle def)
{
    hold(self, sim, "InstrumentTie", readDef<prefab::InstrumentTieDef>(def, "InstrumentTie: definition"));
    sim.shownBeside.insert(self->prefab->driver().body());
}

BodyId handOf(const prefab::InstrumentTie& tie) { return tie.hand(); }
BodyId driverOf(const prefab::InstrumentTie& tie) { return tie.driver().body(); }

} // namespace

void addInstrumentTie(nb::module_& module)
{
    nb::class_<HeldTie>(module, "InstrumentTie",
                        "A hand and a needle driver that tie a knot with the ends of a rod, throw by throw. The driver "
                        "is drawn.")
        .def("__init__", &make, nb::arg("sim"), nb::arg("definition").none(),
             nb::sig("def __init__(self, sim: filasofia.Simulation, definition: filasofia.InstrumentTieDef) -> None"),
             "Adds the hand, the driver and what helps them.")
        .def(
            "begin", [](HeldTie& self) { self.open("begin").begin(); },
            "They take the thread and tie all throws; then hand and assistant hold their strands, slack.")
        .def(
            "release", [](HeldTie& self) { self.open("release").release(); },
            "They let the thread go; begin() starts anew. Call it before a reset.")
        .def_prop_ro(
            "tied", [](HeldTie& self) { return self.open("tied").tied(); }, "[-], throws that are tied and tightened")
        .def_prop_ro(
            "done", [](HeldTie& self) { return self.open("done").done(); }, "whether all throws are tied")
        .def_prop_ro(
            "failed", [](HeldTie& self) { return self.open("failed").failed(); },
            "whether it has given up; the log says why")
        .def_prop_ro(
            "largest_force", [](HeldTie& self) { return self.open("largest_force").largestForce(); },
            "[N], largest force with which the hand has drawn at its strand since begin(), and the driver at the tail")
        .def_prop_ro(
            "hand", [](HeldTie& self) { return Convert<BodyId>::make(handOf(self.open("hand"))); },
            nb::for_getter(nb::sig("def hand(self) -> filasofia.BodyId")), "the body that moves the first node")
        .def_prop_ro(
            "driver", [](HeldTie& self) { return Convert<BodyId>::make(driverOf(self.open("driver"))); },
            nb::for_getter(nb::sig("def driver(self) -> filasofia.BodyId")), "the body of the needle driver");
}

} // namespace filasofia::python
