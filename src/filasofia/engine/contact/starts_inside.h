#pragma once

#include "filasofia/engine/contact/contact_surfaces.h"

#include <array>
#include <span>
#include <vector>

/// Bodies that start inside each other, deeper than contacts are followed.
namespace filasofia::engine {

/// Notes the pairs of surfaces that start with points inside each other: from then on they are tested at any depth.
/// `added`: per surface, whether it is new. To be called after findProximities().
void noteStartsInside(const std::vector<SurfaceOwner>& owners, const std::vector<bool>& added, Coupling& coupling);

/// Adds the contacts of points that are inside a closed rigid surface at any depth, for those pairs and for those that
/// contact has lost.
void addDeepPoints(const std::vector<SurfaceOwner>& owners, ContactDetection& detection);

/// Warns, once per pair of bodies, of those that start inside each other: the pairs of surfaces noted above, those that
/// pass through each other (`crossing`, from reportIntersections()), solids that lie in each other face on face, and
/// rods whose tube is in another body.
void warnOfStartsInside(const Scene& scene, const std::vector<SurfaceOwner>& owners, const std::vector<bool>& added,
                        std::span<const std::array<int, 2>> crossing, const Coupling& coupling);

} // namespace filasofia::engine
