#pragma once

#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

#include <vector>

namespace filasofia::engine {

/// If shells would pass through themselves, each other or tissue in the step as it was solved, changes the solved
/// velocities by impulses that push both apart, without friction (Bridson, Fedkiw and Anderson 2002), and adds these
/// contacts. What they do not part, as they contradict each other, ends the step as one piece (Provot 1997). Momentum
/// stays, but for what is pinned, which does not move, and the spin of such pieces. Returns the soft bodies with such
/// pieces, ascending. `rounds`: of impulses; each finds what the last one has missed.
std::vector<std::size_t> keepShellsApart(const StepContext& context, Scene& scene, Coupling& coupling, int rounds = 25);

} // namespace filasofia::engine
