#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/collision/surface_pair.h"

#include <array>
#include <vector>

namespace filasofia::engine {

/// A place where an edge of one surface passes through a triangle of another, or of the same.
struct SurfaceCrossing {
    /// The surfaces' indices in the list: of the edge, of the triangle.
    std::array<int, 2> surfaces{};
    std::array<int, 2> edge{}; ///< its vertices
    geometry::Triangle triangle{};
    double along = 0.0; ///< [-] in (0, 1), where on the edge
    Vec3 place;         ///< [m]
    /// [m] >= 0. In a closed surface: how deep this part of the edge is inside, up to the next crossing. Otherwise, and
    /// if a surface crosses itself: how far the shorter part of the edge reaches beyond the triangle's plane.
    double depth = 0.0;
    /// The edge passes right through: a sheet, or a closed surface by two faces that look in opposite directions.
    bool through = false;
};

/// Finds every edge that passes through a triangle, both in use.
/// Surfaces that are only near each other have no crossing, whatever their contacts say: this knows nothing of
/// proximities and of history. If a surface is tested against itself, features that are near each other at rest do not
/// cross. Appends to `found`, in an order that does not depend on the number of threads. To be called after
/// findProximities(), for a pair whose boxes overlap.
void findSurfaceCrossings(const SurfacePair& meeting, WorkerPool& pool, ProximityScratch& scratch,
                          std::vector<SurfaceCrossing>& found);

} // namespace filasofia::engine
