#pragma once

#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/scene/scene.h"

#include <span>
#include <vector>

/// The cached contacts of the last step, from which the next solve starts.
namespace filasofia::engine {

/// Passes the last step's forces on to this step's contacts: to the same pair of features or, if a contact has moved to
/// other features, to the nearest new contact of the two bodies. Each force goes to one contact at most.
void inheritForces(double dt, const std::vector<CachedContact>& cache, std::span<Constraint> contacts);

/// Per contact, whether another one of the same two bodies nearby pushes the opposite way, both deeper than they are
/// apart along their normals. This occurs at a thin tip between two folds of tissue that hang together, or at a shaft
/// across a fold that cannot bend so sharply. No motion satisfies both, and forces carried from step to step would grow
/// without bound.
std::vector<bool> contradicted(std::span<const Constraint> contacts);

/// Removes all entries with features of a surface that is being replaced.
void forgetSurface(SurfaceName name, Scene& scene);

/// Sorts cached contacts into the order in which they are searched.
void sortCache(std::vector<CachedContact>& cache);

} // namespace filasofia::engine
