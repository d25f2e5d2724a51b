#pragma once

#include "filasofia/engine/rupture/pieces.h"
#include "filasofia/engine/rupture/stroke.h"
#include "filasofia/engine/rupture/tear.h"
#include "filasofia/frame/boundary.h"
#include "filasofia/sofa/soft_plan.h"

#include <memory>
#include <set>

namespace filasofia::sofaengine {

/// The mesh of a body that may be cut or torn, and what is kept about it besides its plan. Elements and nodes have the
/// same numbers in both.
struct SoftCuts {
    explicit SoftCuts(const SoftPlan& plan);

    engine::EditableMesh mesh;
    engine::Pieces pieces;
    SoftPlan start;               ///< before the first edit, with the material that it has by now
    std::vector<int> origin = {}; ///< per tetrahedron: that of `start` which it is a part of
    std::vector<engine::Stroke> strokes = {};
    engine::Tearing tearing = {};
    bool followed = false;      ///< the mesh moved with the body in the last step
    std::set<int> removed = {}; ///< numbers of pieces
    std::uint64_t revision = 0; ///< changes of the boundary
    std::uint64_t history = 0;  ///< hash of all edits and removals
    std::shared_ptr<const frame::Boundary> boundary = {};
};

/// A body's mesh and plan between two steps.
struct CutState {
    SoftPlan plan;
    SoftCuts cuts;
};

/// Makes the boundary that frames have anew, as another revision.
void publishBoundary(SoftCuts& cuts);

/// Gives the tetrahedra of a cut body the densities, strengths and stiffness of those that they are parts of.
void inheritTissue(const SoftCuts& cuts, SoftPlan& plan);

/// Takes the elements of a piece off a plan: they are in no surface, and nothing will move them. False if there is no
/// such piece, or if it is all that is left. The attachments of its nodes are the caller's.
bool removePiece(int piece, SoftCuts& cuts, SoftPlan& plan);

/// Per node, 1 if it is in no element that is left.
std::vector<char> goneNodes(const SoftPlan& plan);

/// The numbers of pieces that are farther than `far` [m] from their places at rest (engine/rupture/pieces.h).
std::vector<int> piecesBeyond(double far, const SoftCuts& cuts, const std::vector<Vec3>& positions);

} // namespace filasofia::sofaengine
