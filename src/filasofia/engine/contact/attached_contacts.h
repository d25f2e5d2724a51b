#pragma once

#include "filasofia/engine/contact/coupling.h"

/// The interplay of contacts and attachments.
namespace filasofia::engine {

/// Turns this step's contacts into the attachments of the pending grasps.
void graspContacts(const Coupling& coupling, Scene& scene, physics::StepReport& report);

/// Removes the contacts between points that a hard attachment already fixes to each other. All other contacts between
/// two bodies that are hard-attached to each other only stop their approach, and do not push them apart. Two
/// constraints that require different motions of one point would work against each other with forces that grow without
/// bound.
void leaveToAttachments(const Scene& scene, Coupling& coupling);

} // namespace filasofia::engine
