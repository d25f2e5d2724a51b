#pragma once

#include "filasofia/engine/collision/meeting.h"

#include <vector>

namespace filasofia::engine {

/// Before and after the pairs of a step: forgets the sides of surfaces whose shape is another now, and takes over the
/// new sides.
void beginSides(const std::vector<CollisionSurface>& surfaces, ProximityScratch& scratch);
void endSides(ProximityScratch& scratch);

/// Of the minima in scratch.parts, appends those that count: decides which points are inside, drops what is there
/// twice and what is too far, and keeps the sides.
void keepMinima(const Meeting& meeting, ProximityScratch& scratch, std::vector<Proximity>& found);

} // namespace filasofia::engine
