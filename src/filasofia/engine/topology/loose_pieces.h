#pragma once

#include "filasofia/engine/integration/euler.h"
#include "filasofia/engine/rupture/pieces.h"
#include "filasofia/engine/scene/scene.h"

#include <functional>

/// A loose piece is light compared with the body, and solvers judge errors on the whole body: an error that is
/// negligible for the body can throw a fragment of a few elements about. Loose pieces are therefore treated separately.
namespace filasofia::engine {

/// The pieces that a body has fallen into, by ascending number, without removed ones. Empty if the body is whole.
std::vector<BodyPiece> findPieces(const SoftModel& model, const Pieces& pieces);

/// Adds mass, centre of mass and `held` of the body's pieces to those that came loose.
void measure(const SoftModel& model, const SoftState& state, std::vector<physics::LoosePiece>& loose);

/// Updates `held` of every piece: whether pins hold it. Call this after the pins changed.
void findHeld(const Pins& pins, std::vector<BodyPiece>& pieces);

/// The result of a solve of A dv = b at one node, with its residual b - A dv.
struct NodeSolve {
    Vec3 dv;       ///< [m/s]
    Vec3 residual; ///< [N s] residual
};

/// Continues the solve of an implicit step for small fragments: pieces of few elements that are not pinned and have no
/// constrained node. Each is solved separately until its residual has fallen to a millionth. The results replace `dv`
/// of these nodes in the system, whatever the solve of the whole body found, and their residuals are not carried on. A
/// fragment changes its shape by at most half of its size in a step. Those that are nearly incompressible are left to
/// the solve of the body.
void finishFragments(SoftBody& body, ImplicitWeights weights, const std::vector<char>& constrained,
                     const std::function<NodeSolve(int node)>& solved);

/// Limits the rotation of unpinned pieces to `maxTurn` [rad] per step. Steps of dt [s] cannot follow a faster rotation,
/// which would only gain energy. Linear momentum is conserved.
void limitSpin(const SoftModel& model, double maxTurn, double dt, SoftState& state);

/// The same as in rupture/pieces.h, of a body that has fallen into pieces.
std::vector<int> piecesBeyond(double far, const SoftModel& model, const SoftState& state);

} // namespace filasofia::engine
