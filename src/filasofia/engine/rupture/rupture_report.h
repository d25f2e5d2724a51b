#pragma once

#include "filasofia/math/vec3.h"

namespace filasofia::engine {

/// Why something asked of a mesh was not done. The mesh is then as it was.
enum class RuptureRefusal {
    BladeNotFinite, ///< a NaN or an infinity in the blade's positions
    BladeNoLength,  ///< no segment has any
    BladeJump,      ///< went further in one step than the body's box is long
    EdgeGone,       ///< a crossing that waited for its turn: its edge had been cut in the meantime
    TearClosed,     ///< a tear that would have opened no face, or none that keeps the mesh manifold
    count_
};
constexpr int kRuptureRefusals = static_cast<int>(RuptureRefusal::count_);
constexpr const char* name(RuptureRefusal refusal)
{
    constexpr const char* kNames[] = {"blade not finite", "blade without length", "blade jump", "edge gone",
                                      "tear stays closed"};
    return kNames[static_cast<int>(refusal)];
}

/// What was done, and what was repaired on the way. Sums over steps are sums of the members, but for `pending`.
struct RuptureReport {
    long refused[kRuptureRefusals] = {}; ///< per reason
    // cutting
    long crossings = 0;    ///< of an edge and a blade
    long snapped = 0;      ///< crossings taken to a node nearby
    long snappedGuard = 0; ///< crossings taken to a node because bisecting would have left bad elements
    long moves = 0;        ///< nodes slid onto the surface
    long bisections = 0;   ///< of edges, on the surface
    long pending = 0;      ///< crossings that wait for the next step, at the end of this one
    // opening
    long flagged = 0;       ///< faces
    long edits = 0;         ///< transactions
    long repairedEdits = 0; ///< transactions that needed repair
    long repairRounds = 0;
    long repairBisections = 0;
    long repairFlips = 0;    ///< cones that changed their side
    long repairSlits = 0;    ///< nodes parted so that two loops of boundary became one
    long repairDeferred = 0; ///< faces put off
    long flakes = 0;         ///< elements that would have come loose alone, and changed their side
    long givenUp = 0;        ///< transactions that could not be repaired: their faces stay closed
    long openedFaces = 0;
    long copies = 0;         ///< of nodes
    double openedArea = 0.0; ///< [m^2] at rest, of one of the two sides
    Vec3 openedMoment;       ///< [m^3] the sum of area times place, as it is now: over openedArea, where it happened

    RuptureReport& operator+=(const RuptureReport& b);
};

} // namespace filasofia::engine
