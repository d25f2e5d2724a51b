#pragma once

#include "filasofia/engine/contact/coupling.h"

/// Where contacts and attachments meet.
namespace filasofia::engine {

/// Turns the contacts of this step into the attachments that wait for them.
void graspContacts(const Coupling& coupling, Scene& scene, physics::StepReport& report);

/// Removes the contacts between points that a hard attachment holds together, and keeps the others of two bodies that
/// hold each other hard from parting. Two laws that want different things of one point would work against each other
/// with forces that grow without bound.
void leaveToAttachments(const Scene& scene, Coupling& coupling);

} // namespace filasofia::engine
