#pragma once

#include "filasofia/engine/integration/euler.h"
#include "filasofia/engine/rupture/pieces.h"
#include "filasofia/engine/scene/scene.h"

#include <functional>

/// What came loose of a body is light beside the rest, and solvers judge errors on the whole body: what is none for the
/// body throws a crumb about. So loose pieces get some care of their own.
namespace filasofia::engine {

/// The pieces that a body has fallen into, by rising number, without those that were removed; nothing while it is
/// whole.
std::vector<BodyPiece> findPieces(const SoftModel& model, const Pieces& pieces);

/// Says of every piece whether pins hold it: after they changed.
void findHeld(const Pins& pins, std::vector<BodyPiece>& pieces);

/// What a solve of A dv = b found for a node, and what it left undone: b - A dv.
struct NodeSolve {
    Vec3 dv;     ///< [m/s]
    Vec3 undone; ///< [N s]
};

/// Goes on with the solve of an implicit step for small fragments: pieces of few elements that nothing holds and
/// without a constrained node, each by itself, until a millionth of its residual is left. The system's `dv` of these
/// nodes are the result, whatever the solve of the whole body made of them, and no residual of them is carried on.
void finishFragments(SoftBody& body, ImplicitWeights weights, const std::vector<char>& constrained,
                     const std::function<NodeSolve(int node)>& solved);

/// Keeps pieces that nothing holds from turning by more than `maxTurn` [rad] in a step: what is faster is no motion
/// that steps of dt [s] can follow, and would only gather energy. Their momentum stays.
void limitSpin(const SoftModel& model, double maxTurn, double dt, SoftState& state);

/// Numbers of pieces whose first node is farther than `far` [m] from where it began: the smallest first, by nodes, and
/// last of all 0, the body itself, as what is left of a body is not to be removed.
std::vector<int> piecesBeyond(double far, const SoftModel& model, const SoftState& state);

} // namespace filasofia::engine
