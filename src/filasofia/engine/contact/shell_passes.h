#pragma once

#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/contact/missed_contacts.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

#include <vector>

namespace filasofia::engine {

/// Finds the edges and points of shells that pass through tissue, or through a shell, in the step as it was solved
/// (Provot 1997): each contact keeps the two places that meet first from coming nearer than a tenth of their distance
/// at the start of the step. Features that pass through each other already are left out: they must get apart. Gives the
/// surfaces of these bodies the solved velocities. The same for any number of threads.
std::vector<MissedContact> findShellPasses(const StepContext& context, const Scene& scene, Coupling& coupling);

} // namespace filasofia::engine
