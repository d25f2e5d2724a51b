#pragma once

#include "held_prefab.h"

#include "filasofia/prefab/articulated_instrument.h"

namespace filasofia::python {

using HeldInstrument = HeldPrefab<prefab::ArticulatedInstrument>;

/// The instrument of this simulation that the argument `tool` of a constructor is; throws a TypeError if it is none,
/// and an Error if it is one of another simulation.
prefab::ArticulatedInstrument& readInstrument(nb::handle tool, const HeldSimulation& sim, const char* constructor);

/// The same, if it is an instrument; null if not.
prefab::ArticulatedInstrument* asInstrument(nb::handle tool, const HeldSimulation& sim, const char* constructor);

} // namespace filasofia::python
