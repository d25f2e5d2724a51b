#pragma once

#include "filasofia/engine/coupling.h"

namespace filasofia::engine {

/// Hands the last step's forces on to this step's contacts: to the same pair of features and, where a contact has moved
/// over to other features, to the nearest new contact of the two bodies. Each force goes to one contact at most.
void inheritForces(double dt, const std::vector<ContactMemory>& memories, Coupling& coupling);

/// Forgets what is known of a surface's features: another one is in its place.
void forgetSurface(SurfaceName name, State& state);

/// Puts memories into the order in which they are searched.
void sortMemories(std::vector<ContactMemory>& memories);

} // namespace filasofia::engine
