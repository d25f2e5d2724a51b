#pragma once

#include "filasofia/engine/scene/scene.h"

namespace filasofia::engine {

struct CavityStep {
    Vec3 gravity;    ///< [m/s^2]
    double dt = 0.0; ///< [s]
};

/// Adds what the fill of the body's cavities does to their walls in a step of backward Euler: with the volume V, its
/// gradient g and the fall of pressure k per volume, the pressure on the wall and -h k g (g . v) to the forces [N], and
/// h^2 k g g^T to the matrix (`out`). The pressure of a liquid grows downwards, from the middle of its wall or, if it
/// is open, from its openings. On a closed wall the pressure's force is p g; nothing pushes on the lids of an open one.
void addCavityForces(const CavityStep& step, const SoftModel& model, const SoftState& state, std::vector<Vec3>& forces,
                     std::vector<RankOneStiffness>& out);

/// What flows in by command in a step, and how easily the openings let flow out: 0.61 A sqrt(2 p / rho) through an area
/// A (Torricelli, with the contraction of a jet from a sharp edge), as a conductance at the last step's pressure p. So
/// the outflow is part of the step's solve, and no stiffness of the fill or step length bounds it.
void fillCavities(double dt, Scene& scene);

/// What has flowed out, after the bodies have moved. Reports all cavities.
void drainCavities(double dt, Scene& scene);

} // namespace filasofia::engine
