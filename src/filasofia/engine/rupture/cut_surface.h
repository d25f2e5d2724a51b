#pragma once

#include "filasofia/engine/rupture/open_faces.h"

#include <vector>

namespace filasofia::engine {

/// How a cut treats the mesh. The defaults were measured: below .2/.10 of snap/minQuality the solver pays for slivers,
/// above .3/.15 the surface moves away from the blade.
struct CutParameters {
    double snap = 0.3;         ///< [-], in [0, 0.5]: a crossing nearer than this share of the edge is taken to its node
    double minQuality = 0.15;  ///< [-], in (0, 1): bisecting leaves no worse element
    double shortestEdge = 0.2; ///< [-] of the mean edge: no shorter one is bisected
    bool moveNodes = true;     ///< a node that a crossing is taken to slides there where nothing suffers
    double leastVolume = 0.2;  ///< [-] over rest, of an element as it is now: no slide leaves less
    double slideVolume = 2e-5; ///< [-] of the body's volume: what one node on the boundary may take or give
    double slideVolumes = 3e-4; ///< [-] the same of all together
    int maxNewTetrahedra = 400; ///< [-], >= 1, in one step, a few more for the last edge; the rest follows in the next
};

OpeningLimits openingLimits(const CutParameters& parameters, double meanEdge);

/// An edge that a blade went through.
struct Crossing {
    int a = 0;
    int b = 0;           ///< on the side that the normal points to
    double s = 0.0;      ///< [-], in [0, 1]: from a to b
    Vec3 point = {};     ///< [m] at rest
    Vec3 normal = {};    ///< unit, at rest
    double length = 0.0; ///< [m] of the edge at rest
};

/// Takes the crossings into the mesh: near nodes are labelled (and slid onto the surface), other edges bisected, then
/// faces whose three nodes lie on the sheet, between elements of opposite sides, are flagged and opened. What the limit
/// of new tetrahedra leaves undone stays in `crossings`.
void cutCrossings(EditableMesh& mesh, int sheet, const CutParameters& parameters, std::vector<Crossing>& crossings,
                  RuptureReport& report);

} // namespace filasofia::engine
