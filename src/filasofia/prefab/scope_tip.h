#pragma once

#include "filasofia/prefab/scope_hands.h"

namespace filasofia::prefab {

/// Where the scope's tip is, with its roll.
Pose tipOf(const ScopeHandsDef& def, const ScopeHand& hand);

/// [N] By which a contact of `body` pushes it.
inline Vec3 forceOn(BodyId body, const frame::Contact& contact)
{
    const Vec3 onFirst = contact.normalForce * contact.normal + contact.friction;
    return contact.first == body ? onFirst : -onFirst;
}

} // namespace filasofia::prefab
