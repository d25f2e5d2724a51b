#include "held_prefab.h"
#include "results.h"

#include "filasofia/prefab/knot_hands.h"

namespace filasofia::python {
namespace {

using HeldHands = HeldPrefab<prefab::KnotHands>;

void make(HeldHands* self, HeldSimulation& sim, nb::handle def)
{
    hold(self, sim, "KnotHands", readDef<prefab::KnotDef>(def, "KnotHands: definition"));
}

} // namespace

void addKnotHands(nb::module_& module)
{
    nb::class_<HeldHands>(module, "KnotHands",
                          "Two hands that tie a knot with the ends of a rod, throw by throw. They touch nothing.")
        .def("__init__", &make, nb::arg("sim"), nb::arg("definition").none(),
             nb::sig("def __init__(self, sim: filasofia.Simulation, definition: filasofia.KnotDef) -> None"),
             "Adds the hands and their fingers.")
        .def(
            "begin", [](HeldHands& self) { self.open("begin").begin(); },
            "They take the thread and tie all throws; then they hold both strands up.")
        .def(
            "release", [](HeldHands& self) { self.open("release").release(); },
            "They let the thread go; begin() starts anew. Call it before a reset.")
        .def_prop_ro(
            "tied", [](HeldHands& self) { return self.open("tied").tied(); },
            "[-], throws that were tightened and made the thread the knot that they should")
        .def_prop_ro(
            "done", [](HeldHands& self) { return self.open("done").done(); }, "whether all throws were made")
        .def_prop_ro(
            "largest_force", [](HeldHands& self) { return self.open("largest_force").largestForce(); },
            "[N], largest force with which a hand has drawn at its strand since begin()")
        .def_prop_ro(
            "hands",
            [](HeldHands& self) {
                const prefab::KnotHands& hands = self.open("hands");
                return Convert<std::vector<BodyId>>::make({hands.hand(0), hands.hand(1)});
            },
            nb::for_getter(nb::sig("def hands(self) -> list[filasofia.BodyId]")),
            "the bodies that move the first node and the second one");
}

} // namespace filasofia::python
