#pragma once

#include "stepping.h"

namespace filasofia::python {

/// Simulation; its commands are in commands.cpp, its pictures in pictures.cpp, its saved states in states.cpp, what is
/// measured in measures.cpp, its task in tasks.cpp, its sensors in sensors.cpp.
void bindSimulation(nb::module_& module);
void addCommands(nb::class_<HeldSimulation>& simulation);
void addPictures(nb::class_<HeldSimulation>& simulation);
void addMeasures(nb::module_& module, nb::class_<HeldSimulation>& simulation);
void addClipApplier(nb::module_& module);
void addInstrument(nb::module_& module);
void addInstrumentTie(nb::module_& module);
void addEndoscope(nb::module_& module);
void addKnotHands(nb::module_& module);
void addLaparoscopy(nb::module_& module);
void addSpecimenBag(nb::module_& module);
void addSuctionIrrigator(nb::module_& module);
void addUltrasonicShears(nb::module_& module);
void addWireLoop(nb::module_& module);
void addTasks(nb::module_& module, nb::class_<HeldSimulation>& simulation);
void addSensors(nb::class_<HeldSimulation>& simulation);
void addStates(nb::module_& module, nb::class_<HeldSimulation>& simulation);

/// The session, if it is usable; Error if not.
Session& usable(HeldSimulation& held, const char* what);

} // namespace filasofia::python
