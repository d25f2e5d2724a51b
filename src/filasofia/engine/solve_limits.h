#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/model.h"
#include "filasofia/linalg/matrix_free_cg.h"
#include "filasofia/physics/step.h"

namespace filasofia::engine {

/// When a body's solver ends by itself.
linalg::SolveLimits limitsOf(const SoftModel& model);

/// The limits of every body's solver under a budget: a deadline, or the iterations made when the step was made first.
std::vector<linalg::SolveLimits> limitsOf(const Model& model, const physics::StepBudget* budget,
                                          const WorkerPool& pool);

} // namespace filasofia::engine
