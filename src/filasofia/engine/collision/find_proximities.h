#pragma once

#include "filasofia/core/worker_pool.h"
#include "filasofia/engine/collision/collision_surface.h"
#include "filasofia/engine/collision/proximity.h"
#include "filasofia/engine/collision/side_kept.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace filasofia::engine {

/// Where a point may meet a surface, before it is known whether it is inside.
struct PointMinimum {
    Proximity proximity;     ///< signed as the feature's own normal says
    int point = 0;           ///< vertex of the source
    int source = 0;          ///< which side of the pair the point is on
    double distance = 0.0;   ///< [m], >= 0
    double range = 0.0;      ///< [m] within which it counts, if it is outside
    double back = 0.0;       ///< [m] within which it would, if the other side were outside
    double limit = 0.0;      ///< [m] how deep inside it counts
    bool facing = true;      ///< does the point's own surface look at what it met
    bool twoSided = false;   ///< on a sheet: which side is outside is for its history to tell
    bool vertexPair = false; ///< the nearest place is a vertex
    bool kept = false;
};

/// Buffers of findProximities: nothing in them matters to the next step.
struct ProximityScratch {
    struct Part {
        std::vector<PointMinimum> points;
        std::vector<Proximity> edges;
    };
    std::vector<SideKept> nextSides;
    std::vector<std::array<int, 2>> surfacePairs;
    std::vector<char> wanted;
    std::vector<std::array<int, 2>> elementPairs;
    std::vector<std::array<int, 2>> open;       ///< pairs of nodes still to be looked at
    std::vector<Part> parts;                    ///< never fewer than once
    std::size_t partsUsed = 0;                  ///< by the pair of surfaces that is looked at
    std::array<std::vector<double>, 2> nearest; ///< [m] per vertex of each side: signed distance to the other one
    std::vector<std::uint64_t> vertexPairs;
};

/// Every place where two surfaces of one group are nearer than both proximities plus the way by which they come nearer
/// in one and a half steps, in place of what `found` held. Points meet triangles and lines meet lines; where a surface
/// has no triangles in use, its lines meet points as well, and where it has no lines either, its points do.
///
/// What is found are local minima of the distance, each once: a point's nearest place in a face, on an edge whose
/// triangles have nothing nearer or at such a vertex; edge over edge where the nearest places lie inside both and their
/// triangles have nothing nearer (so flat and concave edges meet nothing). Where the nearest place is on an edge or
/// vertex, the surface around the point must look at it: nothing around it leads there, give or take a degree. A face
/// is met by any point.
///
/// Inside a closed surface a point has one way out, the nearest, and it is found to the sum of both depths. A sheet has
/// no inside: outside is the side on which a point was first seen, until it has been out of range or beside the rim; of
/// its own surface a point is inside only where it has been seen outside before. Without triangles in use no gap is
/// negative.
///
/// dt > 0 [s]. `sides`, ascending: what is known from the last step on; left behind: for the next one. Who gives a
/// surface another shape takes out what is known of the old one. The same surfaces and sides give the same list in the
/// same order for any number of threads. Allocates nothing once its buffers have grown.
void findProximities(std::vector<CollisionSurface>& surfaces, double dt, WorkerPool& pool, std::vector<SideKept>& sides,
                     ProximityScratch& scratch, std::vector<Proximity>& found);

inline constexpr double kStepsAhead = 1.5; ///< a step, and half of one for what the solve adds to the velocities

} // namespace filasofia::engine
