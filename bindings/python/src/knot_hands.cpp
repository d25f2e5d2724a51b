#include "defs.h"
#include "results.h"
#include "simulation.h"

#include "filasofia/prefab/knot_hands.h"

#include <memory>

namespace filasofia::python {
namespace {

/// Hands that tie a knot, as Python holds them. The session outlives them.
struct HeldHands {
    std::shared_ptr<Session> session;
    std::unique_ptr<prefab::KnotHands> hands;
};

void make(HeldHands* self, HeldSimulation& sim, nb::handle def)
{
    const auto read = readDef<prefab::KnotDef>(def, "KnotHands");
    Session& session = usable(sim, "KnotHands");
    const Session::Turn turn(session, "KnotHands");
    auto made = std::make_unique<prefab::KnotHands>(session.simulation(), read);
    new (self) HeldHands{sim.session, std::move(made)};
}

prefab::KnotHands& open(HeldHands& self, const char* what)
{
    self.session->requireUsable(what);
    return *self.hands;
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
            "begin", [](HeldHands& self) { open(self, "begin").begin(); },
            "They take the thread and tie all throws; then they hold both strands up.")
        .def(
            "release", [](HeldHands& self) { open(self, "release").release(); },
            "They let the thread go; begin() starts anew. Call it before a reset.")
        .def_prop_ro(
            "tied", [](HeldHands& self) { return open(self, "tied").tied(); },
            "[-], throws that are tied and tightened")
        .def_prop_ro(
            "done", [](HeldHands& self) { return open(self, "done").done(); }, "whether all throws are tied")
        .def_prop_ro(
            "largest_force", [](HeldHands& self) { return open(self, "largest_force").largestForce(); },
            "[N], largest force with which a hand has drawn at its strand since begin()")
        .def_prop_ro(
            "hands",
            [](HeldHands& self) {
                const prefab::KnotHands& hands = open(self, "hands");
                return Convert<std::vector<BodyId>>::make({hands.hand(0), hands.hand(1)});
            },
            nb::for_getter(nb::sig("def hands(self) -> list[filasofia.BodyId]")),
            "the bodies that move the first node and the second one");
}

} // namespace filasofia::python
