#pragma once

#include "filasofia/engine/contact/coupling.h"

namespace filasofia::engine {

/// Hands the last step's forces on to this step's contacts: to the same pair of features and, where a contact has moved
/// over to other features, to the nearest new contact of the two bodies. Each force goes to one contact at most.
void inheritForces(double dt, const std::vector<ContactMemory>& memories, Coupling& coupling);

/// Of each contact: does another one of the same two bodies push the opposite way near by, both deeper than they are
/// apart along their normals? A thin tip between two folds of tissue that hang together, a shaft across a fold that
/// cannot bend so sharply: no motion satisfies both, and forces that are carried from step to step would grow without
/// end.
std::vector<bool> contradicted(const Coupling& coupling);

/// Forgets what is known of a surface's features: another one is in its place.
void forgetSurface(SurfaceName name, State& state);

/// Puts memories into the order in which they are searched.
void sortMemories(std::vector<ContactMemory>& memories);

} // namespace filasofia::engine
