#pragma once

#include "filasofia/prefab/scope_hands.h"

namespace filasofia::prefab {

/// The pose of the scope's tip, with its roll.
Pose tipOf(const ScopeHandsDef& def, const ScopeHand& hand);
/// The part `t` of the way from a to b.
ScopeHand between(const ScopeHand& a, const ScopeHand& b, double t);

} // namespace filasofia::prefab
