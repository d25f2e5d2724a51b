#pragma once

#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/scene/scene.h"

/// Contacts of tissue where it is pinned, and hardly moves.
namespace filasofia::engine {

/// Whether a solve can change the velocity of a point.
bool canMove(const BodyPoint& point, const Scene& scene, const RigidPlan& plan);

/// Whether two places of solid tissue, not of rods or shells, move by more than half with pinned nodes. They do not
/// hold each other: what is left of them moves so little that a hundredth of a millimetre took thousands of newtons. At
/// both lips of a cut they meet beside a pinned node.
bool arePinned(const Constraint& contact, const Scene& scene);

/// Makes the contact a spring of `stiffness` [N/m], which pushes as far as it is compressed in a step of dt [s].
void yieldAsSpring(double dt, double stiffness, Constraint& contact);

/// Does so with contacts of tissue that moves by more than half with pinned nodes, with rigid bodies that no solve can
/// move, and with jaws of tools that are told: a cube that was driven into tissue beside its pins pushed with 72 kN,
/// and jaws of 20 mN m that were moved over it with 256 MN. Where all nodes are pinned, only what comes nearer begins
/// to push, and not scenery that overlaps them.
void yieldWherePinned(double dt, const Scene& scene, Coupling& coupling);

} // namespace filasofia::engine
