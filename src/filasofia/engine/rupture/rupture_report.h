#pragma once

#include "filasofia/physics/step.h"

namespace filasofia::engine {

/// Why a request was not carried out. The mesh is then unchanged.
enum class RuptureRefusal {
    BladeNotFinite, ///< a NaN or an infinity in the blade's positions
    BladeNoLength,  ///< no segment has a length
    BladeJump,      ///< the blade moved further in one step than the body's diagonal
    EdgeGone,       ///< the edge of a pending crossing was cut in the meantime
    TearClosed,     ///< the tear would open no face, or none that keeps the mesh manifold
    count_
};
constexpr int kRuptureRefusals = static_cast<int>(RuptureRefusal::count_);
constexpr const char* name(RuptureRefusal refusal)
{
    constexpr const char* kNames[] = {"blade not finite", "blade without length", "blade jump", "edge gone",
                                      "tear stays closed"};
    return kNames[static_cast<int>(refusal)];
}

/// Counts what was done and what was repaired. The reports of several steps are added member by member, except
/// `pending`.
struct RuptureReport {
    long refused[kRuptureRefusals] = {}; ///< per reason
    // cutting
    long crossings = 0;    ///< pairs of an edge and a blade
    long snapped = 0;      ///< crossings moved to a near node
    long snappedGuard = 0; ///< crossings moved to a node because a bisection would have left bad elements
    long moves = 0;        ///< nodes slid onto the surface
    long bisections = 0;   ///< bisections of edges on the surface
    long pending = 0;      ///< crossings left for the next step at the end of this one
    long inVain = 0;       ///< strokes that ended, had crossed edges and opened nothing
    // opening
    long flagged = 0;       ///< faces marked for opening
    long edits = 0;         ///< transactions
    long repairedEdits = 0; ///< transactions that needed repair
    long repairRounds = 0;
    long repairBisections = 0;
    long repairFlips = 0;    ///< cones that changed side
    long repairSlits = 0;    ///< nodes split so that two loops of boundary became one
    long repairDeferred = 0; ///< deferred faces
    long flakes = 0;         ///< elements that would have come loose alone and therefore changed side
    long givenUp = 0;        ///< transactions that could not be repaired: their faces stay closed
    long openedFaces = 0;
    long copies = 0;         ///< node copies
    double openedArea = 0.0; ///< [m^2] at rest, counted on one of the two sides
    Vec3 openedMoment;       ///< [m^3] sum of area times current centre; over openedArea: where the faces opened

    RuptureReport& operator+=(const RuptureReport& b);
};

/// Adds the counts of refused, deferred and pending requests.
void add(const RuptureReport& from, physics::TopologyReport& to);
/// Adds what was opened, if anything was, and empties the report.
void moveRupture(physics::Rupture::Kind kind, BodyId body, RuptureReport& opened, physics::TopologyReport& to);

} // namespace filasofia::engine
