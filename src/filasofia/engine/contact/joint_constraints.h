#pragma once

#include "filasofia/engine/contact/coupling.h"

/// Limits and dry friction of free joints, as constraints of a joint against space: solved together with contacts.
namespace filasofia::engine {

/// Adds them after the contacts and the welds. `dt` [s].
void addJointConstraints(double dt, const Scene& scene, Coupling& coupling);

/// Keeps what joints bore in the step of dt [s], and where their next solve starts.
void keepJoints(double dt, const Coupling& coupling, Scene& scene);

} // namespace filasofia::engine
