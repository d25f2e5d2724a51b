#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/physics/physics_engine.h"

namespace filasofia::engine {

/// The parameters and resources of a step, which every stage gets besides the scene.
struct StepContext {
    double dt = 0.0;                             ///< [s], >= 0; 0: time stands still, but commands are applied
    const physics::StepBudget* budget = nullptr; ///< when solves must end; null: no limit
    const physics::ContactMethod& method;        ///< how contacts are solved
    WorkerPool& pool;
    physics::StepReport& report;
};

} // namespace filasofia::engine
