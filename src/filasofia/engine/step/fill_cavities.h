#pragma once

#include "filasofia/engine/scene/scene.h"

namespace filasofia::engine {

struct CavityStep {
    Vec3 gravity;    ///< [m/s^2]
    double dt = 0.0; ///< [s]
};

/// Adds what the fill of the body's cavities does to their walls in a step of backward Euler: with the volume V, its
/// gradient g and the fall of pressure k per volume, p(V) g - h k g (g . v) to the forces [N], and h^2 k g g^T to the
/// matrix (`out`). A liquid adds its weight: its pressure grows downwards.
void addCavityForces(const CavityStep& step, const SoftModel& model, const SoftState& state, std::vector<Vec3>& forces,
                     std::vector<CavityStiffness>& out);

/// What flows in by command and out through openings in a step, after the bodies have moved: 0.61 A sqrt(2 p / rho)
/// through an opening of area A (Torricelli, with the contraction of a jet from a sharp edge), until both pressures are
/// the same. Reports all cavities.
void fillCavities(double dt, Scene& scene);

} // namespace filasofia::engine
