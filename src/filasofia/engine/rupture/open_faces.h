#pragma once

#include "filasofia/engine/rupture/editable_mesh.h"
#include "filasofia/engine/rupture/rupture_report.h"

#include <vector>

namespace filasofia::engine {

/// How far a repair may go.
struct OpeningLimits {
    bool bisect = true;        ///< may a repair bisect edges
    double minQuality = 0.15;  ///< [-] of what bisecting leaves
    double shortestEdge = 0.0; ///< [m] that is bisected
    bool slit = false;         ///< may a repair open faces that nobody asked for, where a cut would end in a node else
    int cone = 24;             ///< [-] elements at most that change side together
    int rounds = 40;           ///< [-] of repair; what is then still wrong stays closed
};

/// Opens the flagged faces at the candidates (and the deferred ones, which get another try), as one transaction: nodes
/// are split, then every edge of an opened face must have its elements in one fan and every node its boundary in one
/// loop. Where not, all is rolled back and repaired: an edge is bisected, a cone of elements that the cut closes around
/// changes its side, or flags are put off; and it is tried again. The mesh is valid before and after, whatever comes.
void openFaces(EditableMesh& mesh, const OpeningLimits& limits, std::vector<int> candidates, RuptureReport& report);

/// All faces that are flagged or deferred get a last try.
void openAll(EditableMesh& mesh, const OpeningLimits& limits, RuptureReport& report);

} // namespace filasofia::engine
