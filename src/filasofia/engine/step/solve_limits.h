#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/contact/islands.h"
#include "filasofia/engine/body/model.h"
#include "filasofia/linalg/matrix_free_cg.h"
#include "filasofia/physics/step.h"

namespace filasofia::engine {

/// When a body's solver ends by itself.
linalg::SolveLimits limitsOf(const SoftModel& model);

/// The limits of every solve of a step.
struct StepLimits {
    std::vector<linalg::SolveLimits> islands; ///< in their order
    std::vector<linalg::SolveLimits> bodies;  ///< per soft body; of those that are in no island
};

/// Under a budget: a deadline, or the iterations made when the step was made first. Whoever is solved first leaves time
/// for who is solved last: each has its share of the time, by its size.
StepLimits limitsOf(const Model& model, std::span<const Island> islands, const physics::StepBudget* budget,
                    const WorkerPool& pool);

} // namespace filasofia::engine
