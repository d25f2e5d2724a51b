#include "defs.h"
#include "simulation.h"

#include <memory>

namespace filasofia::python {
namespace {

/// A saved state, as Python holds it.
struct HeldState {
    std::shared_ptr<const runtime::RunState> state;
    double time = 0.0;       ///< [s]
    std::uint64_t steps = 0; ///< [-]
    double owed = 0.0;       ///< [-] by run()
};

HeldState save(HeldSimulation& self)
{
    const Session::Turn turn(*self.session, "save_state");
    const nb::gil_scoped_release free;
    return {self.session->save(), self.session->time(), self.session->steps(), self.owed};
}

void restore(HeldSimulation& self, nb::handle given)
{
    if (!nb::isinstance<HeldState>(given)) failType({.name = "restore: the state"}, "must be a SavedState", given);
    const auto& held = nb::cast<const HeldState&>(given);
    const Session::Turn turn(*self.session, "restore");
    const nb::gil_scoped_release free;
    self.session->restore(*held.state);
    self.owed = held.owed;
}

} // namespace

void addStates(nb::module_& module, nb::class_<HeldSimulation>& sim)
{
    nb::class_<HeldState>(module, "SavedState", "What Simulation.restore() returns to; it never changes.")
        .def_ro("time", &HeldState::time, "[s]")
        .def_ro("steps", &HeldState::steps, "Number of steps made.")
        .def(
            "__reduce__",
            [](const HeldState&) -> nb::object {
                throw nb::type_error("SavedState: it is memory of its process and cannot be copied or pickled. A "
                                     "recording (record) makes the same steps in another one; so do states of "
                                     "filasofia.gym (SurgicalEnv.save_state), which can be pickled.");
            },
            nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"));
    sim.def(
        "save_state", &save,
        "The present state: bodies, cut meshes, contacts, attachments, time, warm starts, the commands that wait for "
        "the next step, what instruments hold, and how far tasks and measures are. It stays in memory and never "
        "changes. Before the first step, and while a body or a material waits for a step, it is an Error.");
    sim.def("restore", &restore, nb::arg("state").none(),
            nb::sig("def restore(self, state: filasofia.SavedState) -> None"),
            "Returns at once to a state of this simulation, or of another one with the same bodies and rate. The same "
            "commands then give the same bits, and what is measured goes on from there. Error if bodies were added or "
            "removed, if the run is recorded, if it is measured into a .csv file or its sensors are written, or if the "
            "state does not know an instrument or a task.\n\n"
            "The state has all that bodies are, too: materials, masses, friction, damping, gravity. A simulation that "
            "was made with others has those of the state from then on. To vary them from one settled state, restore "
            "it and then give commands: set_material, set_tissue, set_gravity, set_forces, ...");
}

} // namespace filasofia::python
