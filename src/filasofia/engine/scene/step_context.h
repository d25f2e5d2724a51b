#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/physics/physics_engine.h"

#include <cmath>

namespace filasofia::engine {

/// The parameters and resources of a step, which every stage gets besides the scene.
struct StepContext {
    double dt = 0.0;                             ///< [s], >= 0; 0: time stands still, but commands are applied
    const physics::StepBudget* budget = nullptr; ///< when solves must end; null: no limit
    const physics::ContactMethod& method;        ///< how contacts are solved
    WorkerPool& pool;
    physics::StepReport& report;
};

/// Whether what lasts and is costly to look for (intersections, sheathed blades) is looked for in this step: every
/// 10 ms. At 1 kHz `filasofia bench contact` shows no cost of one such test per 10 ms beside its spread.
inline bool isWatchDue(double time, double dt)
{
    constexpr double kInterval = 0.01; // [s]
    // In the middle between two steps, where rounding decides nothing.
    return dt >= kInterval || std::floor((time + 0.5 * dt) / kInterval) != std::floor((time - 0.5 * dt) / kInterval);
}

} // namespace filasofia::engine
