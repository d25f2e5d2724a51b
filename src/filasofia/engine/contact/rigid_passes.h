#pragma once

#include "filasofia/engine/contact/missed_contacts.h"

#include <span>
#include <vector>

namespace filasofia::engine {

/// Tests the centre lines of rods against the surfaces of rigid bodies in the step as it was solved: both may move by
/// many diameters in a step, and otherwise than detection has foreseen. Returns planes that keep apart what would pass.
/// What moves by less than a quarter of the rod's radius is left to contacts, and so is what leaves a body that it is
/// in.
std::vector<MissedContact> findRigidPasses(const StepContext& context, const Scene& scene, Coupling& coupling);

/// The last resort if new solves do not part them: the nodes of the rods move along with the bodies in this step.
void carryAlong(double dt, std::span<const MissedContact> passes, const Coupling& coupling, Scene& scene);

} // namespace filasofia::engine
