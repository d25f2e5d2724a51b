#pragma once

#include "filasofia/engine/rupture/blade_runs.h"
#include "filasofia/engine/rupture/open_faces.h"

#include <vector>

namespace filasofia::engine {

/// How a cut treats the mesh. The defaults were measured: below .2/.10 for snap/minQuality the slivers slow down the
/// solver, above .3/.15 the surface moves away from the blade.
struct CutParameters {
    double snap = 0.3; ///< [-], in [0, 0.5]: a crossing nearer to a node than this fraction of the edge snaps to it
    double minQuality = 0.15;    ///< [-], in (0, 1): no bisection leaves an element of lower quality
    double shortestEdge = 0.2;   ///< [-] fraction of the mean edge: shorter edges are not bisected
    bool moveNodes = true;       ///< a snapped node slides onto the surface if no element suffers
    double minVolumeRatio = 0.2; ///< [-] lower bound of an element's current volume over its rest volume after a slide
    double slideVolume = 2e-5;   ///< [-] fraction of the body's volume that one boundary node's slide may add or remove
    double slideVolumes = 3e-4;  ///< [-] the same for all slides together
    int maxNewTetrahedra = 400; ///< [-], >= 1, per step; the last edge may exceed it; the rest follows in the next step
};

/// The same for a sheet: nodes slide only where it is flat, as area is kept to a billionth. A regular triangle has
/// quality 1, half a square 0.87.
CutParameters sheetParameters();
/// Those of what the mesh is.
inline CutParameters parametersFor(const EditableMesh& mesh)
{
    return mesh.isSheet() ? sheetParameters() : CutParameters{};
}

OpeningLimits openingLimits(const CutParameters& parameters, double meanEdge);

/// A point where a blade crossed an edge.
struct Crossing {
    int a = 0;
    int b = 0;           ///< the end on the side that the normal points to
    double s = 0.0;      ///< [-], in [0, 1], from a to b
    Vec3 point = {};     ///< [m] at rest
    Vec3 normal = {};    ///< unit, at rest; turns smoothly where the blade bends
    Vec3 facet = {};     ///< the same; that of one segment if the blade is not round there
    double length = 0.0; ///< [m] the edge's length at rest
    SweptPlace swept = {};
};

/// Inserts the crossings into the mesh. Near nodes are labelled (and slid onto the surface) and other edges are
/// bisected. Then faces whose three nodes lie on the sheet, between elements of opposite sides, are flagged and opened.
/// If the limit of new tetrahedra is reached, the remaining crossings stay in `crossings`.
void cutCrossings(EditableMesh& mesh, int sheet, const CutParameters& parameters, BladeRuns& blade,
                  std::vector<Crossing>& crossings, RuptureReport& report);

} // namespace filasofia::engine
