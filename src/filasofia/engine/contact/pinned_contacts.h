#pragma once

#include "filasofia/engine/contact/coupling.h"
#include "filasofia/engine/scene/scene.h"

/// Contacts of tissue where it is pinned, and hardly moves.
namespace filasofia::engine {

/// Whether a solve can change the velocity of a point.
bool canMove(const BodyPoint& point, const Scene& scene, const RigidPlan& plan);

/// Whether two places of tissue move by half or more with pinned nodes. They do not hold each other: what is left of
/// them moves so little that a hundredth of a millimetre took thousands of newtons. At both lips of a cut they meet
/// beside a pinned node.
bool arePinned(const Constraint& contact, const Scene& scene);

/// Makes the contact a spring of `stiffness` [N/m], which pushes as far as it is compressed in a step of dt [s].
void yieldAsSpring(double dt, double stiffness, Constraint& contact);

/// Does so with the contacts of such places with rigid bodies that no solve can move: a jaw that was driven into tissue
/// beside its pins pushed with 107 kN. Where all nodes are pinned, only bodies that have moved into them push, and not
/// what has overlapped them from the start.
void yieldWherePinned(double dt, const Scene& scene, Coupling& coupling);

} // namespace filasofia::engine
