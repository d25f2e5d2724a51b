#pragma once

#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace filasofia::testing {

/// A mesh to be cut at random.
struct CutFuzzMesh {
    std::string name = {};
    geometry::TetMesh mesh = {};
    geometry::TriangleMesh shell = {}; ///< cut instead of `mesh` if it has triangles
};

/// A beam, a ball and a sheet one element thick.
std::vector<CutFuzzMesh> cutFuzzShapes();
/// Shells: sheets of a regular and of an irregular mesh, a balloon, a closed cylinder.
std::vector<CutFuzzMesh> shellFuzzShapes();

/// The parameters of a fuzzing run.
struct CutFuzzDef {
    std::uint64_t seed = 1;
    int cuts = 2000;                      ///< [-], >= 1: number of cuts and tears
    std::vector<CutFuzzMesh> meshes = {}; ///< used in turn
    int cutsPerBody = 4;                  ///< [-], >= 1: cuts one after another in the same body
    int checkEvery = 16; ///< [-], >= 1: edits of a cut between two full checks; there is always one at its end
    bool twice = true;   ///< run every body a second time and compare the hashes
    std::function<void(int cuts)> progress = {}; ///< called after every body
};

/// How often something occurred.
struct CutFuzzCount {
    std::string name = {};
    long count = 0;
};

/// One kind of cut.
struct CutFuzzKind {
    std::string name = {};
    long cuts = 0;       ///< [-] cuts of this kind
    long judged = 0;     ///< [-] cuts that should have separated the body
    long incomplete = 0; ///< [-] judged cuts that left a bridge
};

/// The result of a fuzzing run.
struct CutFuzzReport {
    long cuts = 0, bodies = 0, steps = 0, edits = 0, checks = 0;
    std::vector<CutFuzzKind> kinds = {};
    std::vector<CutFuzzCount> faults = {};   ///< broken invariants by name; empty: none
    std::vector<std::string> examples = {};  ///< examples of faults and incomplete cuts: body and cut; at most 20
    std::vector<CutFuzzCount> refusals = {}; ///< refused operations by reason
    std::vector<CutFuzzCount> repairs = {};  ///< repairs and all other counts
    long hashesThatDiffer = 0;               ///< bodies whose second run gave another hash
    double worstQuality = 1.0;               ///< [-] the lowest quality of an element
    /// [-] lowest quality over its bound, the least of the input's and the cut's (0.15; 0.25 in a shell); below 1 is a
    /// fault
    double worstQualityShare = 1e9;
    double volumeDrift = 0.0;          ///< [-] largest relative change of a body's volume, or of a shell's area
    long maxTetrahedra = 0;            ///< the largest number in a body
    std::uint64_t hash = 0;            ///< hash of all bodies after their last cuts
    long incompleteFull = 0, full = 0; ///< judged cuts along planes in a few steps
    long incompleteProgressive = 0, progressive = 0; ///< all other judged cuts

    [[nodiscard]] bool sound() const { return faults.empty() && hashesThatDiffer == 0; }
};

/// Cuts and tears bodies at random and checks all invariants: planes through nodes, edges and faces and off them by 0,
/// 1e-14, 1e-12 and 1e-9 m, curled strips, progressive, interrupted and resumed cuts, cuts along old ones,
/// self-crossing and sawing ones, scissors, tears; also in tissue that deforms during the cut. The same seed gives the
/// same report everywhere.
CutFuzzReport fuzzCuts(const CutFuzzDef& def);

} // namespace filasofia::testing
