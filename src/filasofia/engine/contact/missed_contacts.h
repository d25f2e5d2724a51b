#pragma once

#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

#include <vector>

namespace filasofia::engine {

/// A contact that detection has not foreseen: in the step as it was solved, surfaces would pass through each other.
struct MissedContact {
    Proximity at = {};                      ///< as it is at the start of the step
    bool line = false;                      ///< between two lines: it has no friction
    std::array<std::size_t, 2> bodies = {}; ///< between two lines, or at a shell: indices in Scene::soft
    double mayLose = 0.0;                   ///< [m] at a shell: by how much the two places may come nearer
};

/// Tests all pairs of edges of rods that collide, with the velocities that the solve has given them. A thread weighs
/// milligrams, so contacts cannot be foreseen from how fast it was: one that snaps back moves by many diameters in the
/// step in which it begins to move.
std::vector<MissedContact> findLinePasses(double dt, const Scene& scene, const Coupling& coupling);

/// If a rod moves farther than detection has foreseen, detects anew with its velocity in the solved step. Returns the
/// contacts with anything but lines that are new and would be violated.
std::vector<MissedContact> findUnforeseen(const StepContext& context, const Scene& scene, Coupling& coupling);

} // namespace filasofia::engine
