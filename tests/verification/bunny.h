#pragma once

#include "verification/verification.h"

namespace filasofia::engine {

/// A bunny that stands on its feet under gravity.
inline Stage standingBunny(int elements, const physics::Solver& solver, int threads = 1,
                           const physics::ElasticLaw& law = physics::NeoHookean{})
{
    Stage stage({.threads = threads});
    stage.add(physics::SoftBodyDef{.mesh = bunnyFile(elements),
                                   .material = physics::FemMaterial{.law = law},
                                   .solver = solver,
                                   .attachments = {{.box = geometry::Box{{-1, -1, -1}, {1, 0.045, 1}}}}});
    stage.post(physics::SetGravity{{0, -9.81, 0}});
    return stage;
}

/// [m] Root mean square of the displacements.
inline double displacement(Stage& stage) { return relativeDistance(stage.soft().x, stage.model().rest, 1.0); }

} // namespace filasofia::engine
