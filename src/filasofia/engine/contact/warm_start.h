#pragma once

#include "filasofia/engine/constraint/constraint.h"
#include "filasofia/engine/scene/scene.h"

#include <span>
#include <vector>

/// Contacts of the last step, from which the next solve starts.
namespace filasofia::engine {

/// Hands the last step's forces on to this step's contacts: to the same pair of features and, if a contact has moved
/// over to other features, to the nearest new contact of the two bodies. Each force goes to one contact at most.
void inheritForces(double dt, const std::vector<CachedContact>& cache, std::span<Constraint> contacts);

/// Per contact: does another one of the same two bodies push the opposite way near by, both deeper than they are apart
/// along their normals? A thin tip between two folds of tissue that hang together, or a shaft across a fold that cannot
/// bend so sharply: no motion satisfies both, and forces that are carried from step to step would grow without bound.
std::vector<bool> contradicted(std::span<const Constraint> contacts);

/// Forgets what is known of a surface's features: another one is in its place.
void forgetSurface(SurfaceName name, Scene& scene);

/// Puts cached contacts into the order in which they are searched.
void sortCache(std::vector<CachedContact>& cache);

} // namespace filasofia::engine
