#include "arrays.h"
#include "instrument.h"
#include "results.h"

#include "filasofia/prefab/specimen_bag.h"

namespace filasofia::python {
namespace {

constexpr const char* kVector = "numpy.typing.NDArray[numpy.float64]";

using HeldBag = HeldPrefab<prefab::SpecimenBag>;

void make(HeldBag* self, HeldSimulation& sim, nb::handle tool, nb::handle def)
{
    const auto read = readDef<prefab::SpecimenBagDef>(def, "SpecimenBag: definition");
    if (auto* instrument = asInstrument(tool, sim, "SpecimenBag"))
        hold(self, sim, "SpecimenBag", *instrument, read);
    else
        hold(self, sim, "SpecimenBag", readArgument<BodyId>(tool, "SpecimenBag", "tool"), read);
    drawBeside(*self, sim, false);
}

} // namespace

void addSpecimenBag(nb::module_& module)
{
    const auto vector = [](const char* name) { return text("def ", name, "(self) -> ", kVector); };
    nb::class_<HeldBag>(
        module, "SpecimenBag",
        "A bag of thin film whose mouth the two arms of an instrument spread. Its film is drawn; it stays if this "
        "object is gone.")
        .def("__init__", &make, nb::arg("sim"), nb::arg("tool").none(), nb::arg("definition").none(),
             nb::sig("def __init__(self, sim: filasofia.Simulation, tool: filasofia.ArticulatedInstrument | "
                     "filasofia.BodyId, definition: filasofia.SpecimenBagDef) -> None"),
             "Adds the film. The tool is an instrument of kind 'specimenBag', or a rigid body with two joints, which "
             "move its elements 1 and 2: arms along their -z, open at the start. The bag hangs to the -x of the tool.")
        .def(
            "share",
            [](const HeldBag& self, nb::handle body) {
                return self.open("share").share(readArgument<BodyId>(body, "share", "body"));
            },
            nb::arg("body").none(), nb::sig("def share(self, body: filasofia.BodyId) -> float"),
            "[-], in [0, 1], part of a body's nodes, or of a rigid body's elements, that is in the bag now.")
        .def_prop_ro(
            "body", [](const HeldBag& self) { return Convert<BodyId>::make(self.open("body").body()); },
            nb::for_getter(nb::sig("def body(self) -> filasofia.BodyId")), "the film")
        .def_prop_ro(
            "load", [](const HeldBag& self) { return vectorOf(self.open("load").load()); },
            nb::for_getter(nb::sig(vector("load").c_str())),
            "[N], on the arms now; at rest, the weight of the film and of what is in it")
        .def_prop_ro(
            "mouth", [](const HeldBag& self) { return vectorOf(self.open("mouth").mouth()); },
            nb::for_getter(nb::sig(vector("mouth").c_str())), "[m], the middle of the mouth, in the world");
}

} // namespace filasofia::python
