#pragma once

#include "defs.h"
#include "simulation.h"

#include <memory>

namespace filasofia::python {

/// A prefab, as Python holds it. The session outlives it.
template <class Prefab> struct HeldPrefab {
    std::shared_ptr<Session> session;
    std::unique_ptr<Prefab> prefab;

    /// The prefab, if its session is usable; Error if not.
    Prefab& open(const char* what) const
    {
        session->requireUsable(what);
        return *prefab;
    }
};

/// Makes the prefab of the simulation and what else its constructor takes, in place.
template <class Prefab, class... Given>
void hold(HeldPrefab<Prefab>* self, HeldSimulation& sim, const char* name, const Given&... given)
{
    Session& session = usable(sim, name);
    const Session::Turn turn(session, name);
    auto made = std::make_unique<Prefab>(session.simulation(), given...);
    new (self) HeldPrefab<Prefab>{sim.session, std::move(made)};
}

} // namespace filasofia::python
