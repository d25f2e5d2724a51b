#include "instrument.h"
#include "results.h"

#include "filasofia/prefab/clip_applier.h"

namespace filasofia::python {
namespace {

using HeldApplier = HeldPrefab<prefab::ClipApplier>;

void make(HeldApplier* self, HeldSimulation& sim, nb::handle tool, nb::handle def)
{
    const auto read = readDef<prefab::ClipApplierDef>(def, "ClipApplier: definition");
    if (const auto* instrument = asInstrument(tool, sim, "ClipApplier"))
        hold(self, sim, "ClipApplier", *instrument, read);
    else
        hold(self, sim, "ClipApplier", readArgument<BodyId>(tool, "ClipApplier", "tool"), read);
    for (const BodyId clip : self->prefab->bodies()) sim.shownBeside.insert(clip);
}

} // namespace

void addClipApplier(nb::module_& module)
{
    nb::class_<HeldApplier>(
        module, "ClipApplier",
        "A magazine of clips that an instrument, or any rigid body, closes on soft bodies. Its clips are drawn.")
        .def("__init__", &make, nb::arg("sim"), nb::arg("tool").none(), nb::arg("definition").none(),
             nb::sig("def __init__(self, sim: filasofia.Simulation, tool: filasofia.ArticulatedInstrument | "
                     "filasofia.BodyId, definition: filasofia.ClipApplierDef) -> None"),
             "Adds the clips. The jaws of an instrument close them; a rigid body closes none by itself.")
        .def(
            "close", [](HeldApplier& self) { self.open("close").close(); },
            "Closes the next clip where the tool is, on the target with most nodes between its legs, in the next step.")
        .def(
            "reload", [](HeldApplier& self) { self.open("reload").reload(); },
            "Puts all clips back into the magazine, as a reset does.")
        .def_prop_ro(
            "left", [](HeldApplier& self) { return self.open("left").left(); }, "[-], clips in the magazine")
        .def_prop_ro(
            "applied", [](HeldApplier& self) { return self.open("applied").applied(); },
            "[-], clips that were closed on tissue; known two steps after close()")
        .def_prop_ro(
            "missed", [](HeldApplier& self) { return self.open("missed").missed(); },
            "[-], clips that were closed on nothing")
        .def_prop_ro(
            "slipped", [](HeldApplier& self) { return self.open("slipped").slipped(); },
            "[-], clips among those applied that are on no tissue any more")
        .def_prop_ro(
            "bodies",
            [](HeldApplier& self) { return Convert<std::vector<BodyId>>::make(self.open("bodies").bodies()); },
            nb::for_getter(nb::sig("def bodies(self) -> list[filasofia.BodyId]")),
            "the clips, in the order in which they are used");
}

} // namespace filasofia::python
