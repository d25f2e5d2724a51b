#pragma once

#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/contact/missed_contacts.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

#include <vector>

namespace filasofia::engine {

/// Finds the points and edges of tissue and shells that would pass through a shell, or a shell's through tissue, in the
/// step as it was solved (Provot 1997): the two places that meet first, and by how much they may come nearer, which is
/// nine tenths of their distance, and not below a quarter of both proximities. Features that pass through each other
/// already are left out: they must get apart. So are those that are near each other at rest, bodies whose new state is
/// not usable, and bodies that the solved velocity does not move (ExplicitEuler that is not symplectic). Gives the
/// surfaces the solved velocities. The same for any number of threads.
std::vector<MissedContact> findShellPasses(const StepContext& context, const Scene& scene, Coupling& coupling);

} // namespace filasofia::engine
