#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/engine/scene/step_context.h"
#include "filasofia/engine/topology/loose_pieces.h"

namespace filasofia::engine {

/// Computes forces and stiffness of all soft bodies at the present state. In the state only the elements' rotations
/// change.
void assemble(const StepContext& context, Scene& scene);

/// The parameters with which a body's equations are assembled.
struct Assembly {
    Vec3 gravity;         ///< [m/s^2]
    double dt = 0.0;      ///< [s]
    double inertia = 1.0; ///< [-] factor on the masses in the matrix
    std::vector<ReducedForce> reduced = {};
};

/// The same for one body.
void assembleBody(const Assembly& how, SoftBody& body, WorkerPool& pool);

} // namespace filasofia::engine
