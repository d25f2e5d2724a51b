#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/collision/collision_surface.h"
#include "filasofia/engine/collision/normal_bounds.h"
#include "filasofia/engine/collision/proximity.h"
#include "filasofia/engine/collision/pushed_features.h"
#include "filasofia/engine/collision/sheet_side.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace filasofia::engine {

/// A local minimum of the distance from a point to a surface, before it is known whether the point is inside.
struct PointMinimum {
    Proximity proximity;     ///< signed by the feature's own normal
    int point = 0;           ///< vertex of the source
    int source = 0;          ///< the side of the pair that the point is on
    double distance = 0.0;   ///< [m], >= 0
    double range = 0.0;      ///< [m] maximum distance if the point is outside
    double back = 0.0;       ///< [m] maximum distance if the other side of the sheet is outside
    double limit = 0.0;      ///< [m] maximum depth inside
    bool facing = true;      ///< the point's own surface faces the place that was found
    bool twoSided = false;   ///< on a sheet: the point's history decides which side is outside
    bool vertexPair = false; ///< the nearest place is a vertex
    bool passed = false;     ///< on a solid's own face: the point's tissue has passed through it
    bool kept = false;
};

/// Boxes of a surface in pieces, each as seen by who moves with its piece; see boundPieces().
struct PieceBounds {
    std::vector<Bounds> elements; ///< in the order of the shape's elements; empty: the surface's own are as tight
    std::vector<Vec3> drifts;     ///< [m/s] per piece, the mean of its vertices that are finite; zero if none is
    std::vector<int> sizes;       ///< per piece, the number of these
};

/// Buffers of findProximities. They carry nothing to the next step.
struct ProximityScratch {
    struct Part {
        std::vector<PointMinimum> points;
        std::vector<Proximity> edges;
    };
    std::vector<SheetSide> nextSides;
    std::vector<std::array<int, 2>> surfacePairs;
    std::vector<char> wanted;
    NormalBounds normals;          ///< for a surface that is tested against itself
    std::vector<Vec3> edgeNormals; ///< for a solid that is tested against itself
    PieceBounds ownPiece;          ///< for a surface in pieces that is tested against itself
    std::vector<std::array<int, 2>> elementPairs;
    std::vector<std::array<int, 2>> open;       ///< stack of pairs of nodes still to be visited
    std::vector<Part> parts;                    ///< never shrinks, so that its buffers are reused
    std::size_t partsUsed = 0;                  ///< number used by the current pair of surfaces
    std::array<std::vector<double>, 2> nearest; ///< [m] per vertex of each side: signed distance to the other side
    std::vector<std::uint64_t> vertexPairs;
};

/// Finds every place where two surfaces of one group are nearer than the sum of their proximities plus the distance by
/// which they approach in one and a half steps. Replaces the contents of `found`. Points are tested against triangles
/// and lines against lines. If a surface has no triangles in use, points are tested against its lines, and if it has no
/// lines either, against its points.
///
/// The results are local minima of the distance, each once:
///   - a point's nearest place in a face, on an edge whose triangles have nothing nearer, or at such a vertex;
///   - edge against edge, if the nearest places lie inside both edges and their triangles have nothing nearer (so flat
///     and concave edges do not collide). Edges of which one is tissue that pushed each other in the last step count
///     for longer.
/// If the nearest place is on an edge or vertex, the surface around the point must face it: nothing around the point
/// leads there, within a degree. A face accepts any point.
///
/// Inside a closed surface a point has one way out, the nearest, and it is found up to the sum of both depths. A sheet
/// has no inside: its outside is the side on which a point was first seen, until the point has been out of range or
/// beside the rim. A point is inside its own surface only if it has been seen outside before. Without
/// triangles in use no gap is negative.
///
/// `dt` must be > 0 [s]. `pushed`, ascending, is what pushed in the last step. `sides`, ascending, holds the sides
/// known from it, and is replaced by those for the next. If a surface gets another shape, the caller must remove the
/// entries of the old one from both. The same input gives the same list in the same order for any number of threads.
/// Once its buffers have grown, it allocates nothing.
void findProximities(std::vector<CollisionSurface>& surfaces, double dt, WorkerPool& pool,
                     std::span<const PushedFeatures> pushed, std::vector<SheetSide>& sides, ProximityScratch& scratch,
                     std::vector<Proximity>& found);

/// Whether two surfaces collide if they are near each other; a surface with itself, if both are the same.
bool mayCollide(const CollisionSurface& a, const CollisionSurface& b);

/// [m/s] The mean velocity of a surface's vertices that are finite.
Vec3 driftOf(const CollisionSurface& surface);

inline constexpr double kStepsAhead = 1.5; ///< one step, and half of one for the velocities that the solve adds

/// [m/s] The speed at which the two places come nearer.
double closingSpeed(const std::vector<CollisionSurface>& surfaces, const Proximity& found);

} // namespace filasofia::engine
