#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/constraint/coupled_solve.h"
#include "filasofia/engine/contact/islands.h"
#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"
#include "filasofia/linalg/matrix_free_cg.h"
#include "filasofia/physics/step.h"

namespace filasofia::engine {

/// The limits of a body's own solver.
linalg::SolveLimits limitsOf(const SoftModel& model);

/// The limits and parameters of the coupled solve of an island.
CoupledLimits coupledLimitsOf(const StepContext& context, const Scene& scene, const Island& island,
                              const linalg::SolveLimits& limits);

/// The limits of every solve of a step.
struct StepLimits {
    std::vector<linalg::SolveLimits> islands; ///< in the order of the islands
    std::vector<linalg::SolveLimits> bodies;  ///< per soft body; unused if the body is in an island
};

/// Also applies the step's budget: a deadline, or the iterations of the recorded step if it is replayed. With a
/// deadline each solve gets a share of the time in proportion to its size, so that the first solves leave time for the
/// last.
StepLimits limitsOf(const StepContext& context, const Scene& scene, std::span<const Island> islands);

} // namespace filasofia::engine
