#pragma once

#include "filasofia/engine/rupture/pieces.h"
#include "filasofia/engine/scene/scene.h"

/// A loose piece is light compared with the body, and solvers judge errors on the whole body: an error that is
/// negligible for the body can throw a fragment of a few elements about. Loose pieces are therefore treated separately.
namespace filasofia::engine {

/// The pieces that a body has fallen into, by ascending number, without removed ones. Empty if the body is whole.
std::vector<BodyPiece> findPieces(const SoftModel& model, const Pieces& pieces);

/// Adds mass, centre of mass and `held` of the body's pieces to those that came loose.
void measure(const SoftModel& model, const SoftState& state, std::vector<physics::LoosePiece>& loose);

/// Updates `held` of every piece: whether pins hold it. Call this after the pins changed.
void findHeld(const Pins& pins, std::vector<BodyPiece>& pieces);

/// Limits the rotation of unpinned pieces to `maxTurn` [rad] per step. Steps of dt [s] cannot follow a faster rotation,
/// which would only gain energy. Linear momentum is conserved.
void limitSpin(const SoftModel& model, double maxTurn, double dt, SoftState& state);

/// A loose piece on which only a part of the forces of a user acts.
struct ReducedForce {
    std::size_t piece = 0; ///< in the model's list
    double part = 1.0;     ///< [-]
};
/// What a step of dt [s] reduces on pieces of a rod that nothing holds, so that no force pushes them beyond 100 m/s.
/// What pulled a thread still pulls when that has torn, and the piece may weigh next to nothing.
std::vector<ReducedForce> reducedForces(double dt, const SoftBody& body, const Scene& scene);

/// Tells in the log that a rod has come apart, and forces act on pieces that nothing holds.
void tellForces(const std::vector<physics::LoosePiece>& loose, const SoftBody& body, const Scene& scene);

/// The same as in rupture/pieces.h, of a body that has fallen into pieces.
std::vector<int> piecesBeyond(double far, const SoftModel& model, const SoftState& state);

} // namespace filasofia::engine
