#pragma once

#include "filasofia/engine/contact/coupling.h"

namespace filasofia::engine {

/// Finds who touches whom, and makes a constraint of every contact, with the force of the last step as its start. Rigid
/// bodies are planned already.
void findContacts(const StepContext& context, const Scene& scene, Coupling& coupling);

/// Keeps what the contacts did in the step: forces for frames and logs, and where their next solve starts.
void keepContacts(const StepContext& context, const Coupling& coupling, Scene& scene);

} // namespace filasofia::engine
