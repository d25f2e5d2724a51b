#pragma once

#include "filasofia/engine/body/soft_model.h"

#include <vector>

namespace filasofia {
class WorkerPool;
}

namespace filasofia::engine {

/// [Pa] Von Mises' stress of a Cauchy stress: sqrt(3/2) times the norm of its deviator.
double vonMises(const Mat3& stress);

/// Lets every element flow whose von Mises stress is beyond its yield stress: its shape at rest changes, without its
/// volume, until it bears the yield stress (ideal plasticity, F = F_e F_p, with the radial return in logarithmic
/// strain; Simo and Hughes 1998, section 9.3). The principal axes of isotropic laws stay. If the shape at rest would be
/// stretched too far to compute with, an element stops to flow. Returns the elements that flowed, ascending.
std::vector<int> flow(const SoftState& state, WorkerPool& pool, SoftModel& model);

} // namespace filasofia::engine
