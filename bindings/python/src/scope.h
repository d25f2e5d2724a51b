#pragma once

#include "held_prefab.h"

namespace filasofia::python {

/// Makes a prefab that pictures look through, of its Def or without one.
template <class Prefab, class Def>
void makeScope(HeldPrefab<Prefab>* self, HeldSimulation& sim, nb::handle given, const char* name)
{
    const Def def = given.is_none() ? Def{} : readDef<Def>(given, text(name, ": definition"));
    if (usable(sim, name).begun()) fail(name, ": the run has begun: make it before the first step or picture");
    hold(self, sim, name, def);
    const Session::Turn turn(*sim.session, name);
    sim.session->simulation().dress([seen = std::weak_ptr(self->prefab)](visual::VisualServer& server) {
        if (const auto scope = seen.lock()) scope->dress(server);
    });
    drawBeside(*self, sim, true);
}

/// What all scopes have: a lens that becomes dirty, and a camera.
template <class Prefab> void addLens(nb::class_<HeldPrefab<Prefab>>& bound)
{
    using Held = HeldPrefab<Prefab>;
    bound
        .def(
            "soil",
            [](Held& self, nb::handle mist, nb::handle smear) {
                self.open("soil").soil({.mist = readArgument<double>(mist, "soil", "mist", closed(0, 1)),
                                        .smear = readArgument<double>(smear, "soil", "smear", closed(0, 1))});
            },
            nb::arg("mist").none() = 0.0, nb::arg("smear").none() = 0.0,
            nb::sig("def soil(self, mist: float = 0.0, smear: float = 0.0) -> None"),
            "Makes the lens as dirty as this, from the next step on; without arguments it is wiped.")
        .def_prop_ro(
            "lens", [](Held& self) { return self.open("lens").lens(); }, "as of the last step")
        .def_prop_ro(
            "camera", [](Held& self) { return Convert<Pose>::make(self.open("camera").camera()); },
            nb::for_getter(nb::sig("def camera(self) -> filasofia.Pose")), "looks along -z; +y is up in the picture");
}

} // namespace filasofia::python
