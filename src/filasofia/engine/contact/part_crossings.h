#pragma once

#include "filasofia/engine/contact/contact_surfaces.h"
#include "filasofia/engine/scene/step_context.h"

namespace filasofia::engine {

/// Where two surfaces of tissue, or of two free rigid bodies, that contact has lost pass through each other, or a sheet
/// through itself, replaces the proximities there by ways out: edge and triangle move in the direction in which the
/// line where the surfaces meet becomes shorter (Volino and Magnenat-Thalmann, Resolving surface collisions through
/// intersection contour minimization, 2006). That needs neither an inside nor a history. With the unit vectors
///
///     E    along the edge                N    normal of the triangle
///     R_i  along the line of intersection, from the edge into its adjacent triangle i
///
/// the edge moves by a positive multiple of the sum of R_i - (E . R_i) / (E . N) N relative to the triangle; moved
/// along itself it would change nothing. What has not parted after a second has no room to: it is only told from then
/// on. To be called after findProximities().
void partCrossings(const StepContext& context, const Scene& scene, const std::vector<SurfaceOwner>& owners,
                   ContactDetection& detection);

/// Whether both have faces, and are tissue, or rigid bodies that nobody tells where to be: out of a floor, the shorter
/// way may be downwards. Points of tissue in a rigid body are led out of it in another way, and so are rods.
bool partsFrom(const SurfaceOwner& one, const SurfaceOwner& two, const Scene& scene);

} // namespace filasofia::engine
