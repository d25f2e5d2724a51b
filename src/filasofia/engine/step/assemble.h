#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"

namespace filasofia::engine {

/// Forces and stiffness at the present state. Of the state it updates the elements' rotations only.
void assemble(const StepContext& context, Scene& scene);

/// What a body's equations are assembled for.
struct Assembly {
    Vec3 gravity;         ///< [m/s^2]
    double dt = 0.0;      ///< [s]
    double inertia = 1.0; ///< [-] the masses count so many times
};

/// The same for one body.
void assembleBody(const Assembly& how, SoftBody& body, WorkerPool& pool);

} // namespace filasofia::engine
