#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/constraint/coupled_solve.h"
#include "filasofia/engine/contact/islands.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"
#include "filasofia/linalg/matrix_free_cg.h"
#include "filasofia/physics/step.h"

namespace filasofia::engine {

/// When a body's solver ends by itself.
linalg::SolveLimits limitsOf(const SoftModel& model);

/// How an island is solved.
CoupledLimits coupledLimitsOf(const StepContext& context, const Scene& scene, const Island& island,
                              const linalg::SolveLimits& limits);

/// The limits of every solve of a step.
struct StepLimits {
    std::vector<linalg::SolveLimits> islands; ///< in their order
    std::vector<linalg::SolveLimits> bodies;  ///< per soft body; of those that are in no island
};

/// Under a budget: a deadline, or the iterations made when the step was made first. Whoever is solved first leaves time
/// for who is solved last: each has its share of the time, by its size.
StepLimits limitsOf(const StepContext& context, const Scene& scene, std::span<const Island> islands);

} // namespace filasofia::engine
