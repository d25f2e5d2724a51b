#pragma once

#include "filasofia/engine/collision/collision_surface.h"
#include "filasofia/engine/collision/proximity.h"
#include "filasofia/engine/contact/contact_surfaces.h"

namespace filasofia::engine {

/// [m], >= 0. By how much two places of one surface are nearer to each other at rest than the gap that contacts keep,
/// as contacts measure it. Where walls meet at an acute angle, as in the crotch of a forked vessel, they are; contacts
/// that pushed them apart by it pressed such a vessel with 1.9 N for ever and turned its elements inside out.
/// `skin` [m]: that gap.
double nearerAtRest(const SurfaceOwner& owner, const Proximity& found, double skin, CollisionSurface& surface,
                    std::vector<Vec3>& normals);

} // namespace filasofia::engine
