#pragma once

#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/contact/missed_contacts.h"

#include <span>

namespace filasofia::engine {

/// Finds the contacts between bodies, and makes a constraint of each, which starts from the last step's force. Rigid
/// bodies must already be planned.
void findContacts(const StepContext& context, const Scene& scene, Coupling& coupling);

/// Adds these contacts, which what was solved has missed.
void addMissed(const StepContext& context, std::span<const MissedContact> missed, const Scene& scene,
               Coupling& coupling);

/// Stores the results of the step's contacts: forces for frames and logs, and the starts of their next solve.
void keepContacts(const StepContext& context, const Coupling& coupling, Scene& scene);

} // namespace filasofia::engine
