#pragma once

#include "filasofia/engine/rupture/editable_mesh.h"
#include "filasofia/engine/rupture/rupture_report.h"

#include <vector>

namespace filasofia::engine {

/// Limits of a repair.
struct OpeningLimits {
    bool bisect = true;        ///< a repair may bisect edges
    double minQuality = 0.15;  ///< [-] lowest quality that a bisection may leave
    double shortestEdge = 0.0; ///< [m] shorter edges are not bisected
    bool slit = false;         ///< a repair may open unflagged faces if a cut would otherwise end in a node
    int cone = 24;             ///< [-] maximum number of elements that change side together
    int rounds = 40;           ///< [-] maximum rounds of repair; faces that are then still invalid stay closed
};

/// Opens the flagged faces at the candidates, and tries the deferred ones there again, as one transaction. Nodes are
/// split, then the elements of every edge of an opened face must form one fan and the boundary faces of every node one
/// loop. If they do not, the transaction is rolled back and repaired: an edge is bisected, a cone of elements that the
/// cut surrounds changes its side, or flags are deferred. Then the opening is tried again. The mesh is valid before and
/// after in every case.
void openFaces(EditableMesh& mesh, const OpeningLimits& limits, std::vector<int> candidates, RuptureReport& report);

/// Tries all faces that are flagged or deferred a last time. If few of the sheet are left, they may take slits with
/// them.
void openAll(EditableMesh& mesh, int sheet, const OpeningLimits& limits, RuptureReport& report);

} // namespace filasofia::engine
