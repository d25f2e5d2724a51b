#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/physics/physics_engine.h"

namespace filasofia::engine {

/// What every stage of a step is given besides the scene.
struct StepContext {
    double dt = 0.0;                             ///< [s], >= 0; 0: time stands still, commands are applied all the same
    const physics::StepBudget* budget = nullptr; ///< when solves must end; null: never
    const physics::ContactMethod& method;        ///< how bodies that touch push each other
    WorkerPool& pool;
    physics::StepReport& report;
};

} // namespace filasofia::engine
