#pragma once

#include "defs.h"
#include "simulation.h"

#include <memory>
#include <utility>

namespace filasofia::python {

/// A prefab, as Python holds it. The session outlives it.
template <class Prefab> struct HeldPrefab {
    std::shared_ptr<Session> session;
    std::shared_ptr<Prefab> prefab;

    /// The prefab, if its session is usable; Error if not.
    Prefab& open(const char* what) const
    {
        session->requireUsable(what);
        return *prefab;
    }
};

/// Makes the prefab of the simulation and what else its constructor takes, in place.
template <class Prefab, class... Given>
void hold(HeldPrefab<Prefab>* self, HeldSimulation& sim, const char* name, Given&&... given)
{
    Session& session = usable(sim, name);
    const Session::Turn turn(session, name);
    auto made = std::make_shared<Prefab>(session.simulation(), std::forward<Given>(given)...);
    new (self) HeldPrefab<Prefab>{sim.session, std::move(made)};
}

/// The prefab is drawn beside all other bodies; with `kept`, its steps go on when Python has let it go.
template <class Prefab> void drawBeside(HeldPrefab<Prefab>& self, HeldSimulation& sim, bool kept)
{
    if (kept) sim.session->keep(self.prefab);
    sim.shownBeside.insert(self.prefab->body());
}

} // namespace filasofia::python
