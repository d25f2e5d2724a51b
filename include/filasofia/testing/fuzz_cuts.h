#pragma once

#include "filasofia/geometry/tet_mesh.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace filasofia::testing {

/// A body to be cut at random.
struct CutFuzzMesh {
    std::string name = {};
    geometry::TetMesh mesh = {};
};

/// A beam, a ball and a sheet one element thick.
std::vector<CutFuzzMesh> cutFuzzShapes();

struct CutFuzzDef {
    std::uint64_t seed = 1;
    int cuts = 2000;                      ///< [-], >= 1, tears among them
    std::vector<CutFuzzMesh> meshes = {}; ///< taken in turn
    int cutsPerBody = 4;                  ///< [-], >= 1, one after another in the same body
    int checkEvery = 16; ///< [-], >= 1, edits of a cut between two looks at everything; at its end always
    bool twice = true;   ///< every body a second time: the same hash?
    std::function<void(int cuts)> progress = {}; ///< called after every body
};

/// How often something was.
struct CutFuzzCount {
    std::string name = {};
    long count = 0;
};

/// One kind of cut.
struct CutFuzzKind {
    std::string name = {};
    long cuts = 0;
    long judged = 0;     ///< of which it can be said that they should have separated something
    long incomplete = 0; ///< of these, that left a bridge
};

struct CutFuzzReport {
    long cuts = 0, bodies = 0, steps = 0, edits = 0, checks = 0;
    std::vector<CutFuzzKind> kinds = {};
    std::vector<CutFuzzCount> faults = {};   ///< broken invariants by name; empty: none
    std::vector<std::string> examples = {};  ///< of broken invariants: which body and cut
    std::vector<CutFuzzCount> refusals = {}; ///< by reason
    std::vector<CutFuzzCount> repairs = {};  ///< and everything else that was counted
    long hashesThatDiffer = 0;
    double worstQuality = 1.0;                       ///< [-]
    double worstQualityShare = 1e9;                  ///< [-] over the bound min(input, 0.15): below 1 is a fault
    double volumeDrift = 0.0;                        ///< [-] the largest of a body
    long mostTetrahedra = 0;                         ///< of a body
    std::uint64_t hash = 0;                          ///< of all bodies at their ends
    long incompleteFull = 0, full = 0;               ///< planes in a few steps
    long incompleteProgressive = 0, progressive = 0; ///< all others that are judged

    [[nodiscard]] bool sound() const { return faults.empty() && hashesThatDiffer == 0; }
};

/// Cuts and tears bodies at random and looks at everything: planes through nodes, edges and faces and off them by 0,
/// 1e-14, 1e-12 and 1e-9 m, curled strips, progressive, interrupted and resumed cuts, cuts along old ones,
/// self-crossing and sawing ones, scissors, tears; in tissue that deforms meanwhile. The same seed gives the same
/// report everywhere.
CutFuzzReport fuzzCuts(const CutFuzzDef& def);

} // namespace filasofia::testing
