#pragma once

#include "engine/elastic/laws.h"
#include "engine/stage.h"
#include "engine/volumes.h"

namespace filasofia::engine {

/// The bunny under its weight, held by its ears.
inline Stage hangingBunny(int elements, const physics::SoftMaterial& material = physics::FemMaterial{},
                          double period = 1e-3, const physics::Solver& solver = physics::ConjugateGradient{},
                          physics::Rayleigh damping = {})
{
    Stage stage({.period = period, .threads = 1});
    stage.add(physics::SoftBodyDef{.mesh = bunnyFile(elements),
                                   .material = material,
                                   .rayleigh = damping,
                                   .solver = solver,
                                   .attachments = {{.box = geometry::Box{{-1, 0.105, -1}, {1, 1, 1}}}}});
    stage.post(physics::SetGravity{{0, -9.81, 0}});
    return stage;
}

/// [J] Sum of kinetic, elastic and potential energy.
inline double mechanicalEnergy(Stage& stage, double gravity = 9.81)
{
    double sum = 0.0;
    const SoftState& state = stage.soft();
    for (const FemElement& element : stage.model().elements) {
        Corners x;
        for (std::size_t i = 0; i < 4; ++i) x[i] = state.x[element.nodes[i]];
        sum += engine::energyOf(stage.model().material.law, element, x);
    }
    sum += nodalEnergy(stage.model(), state.x);
    for (std::size_t i = 0; i < state.v.size(); ++i)
        sum += stage.model().masses[i] * (0.5 * lengthSquared(state.v[i]) + gravity * state.x[i].y);
    return sum;
}

} // namespace filasofia::engine
