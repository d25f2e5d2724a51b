#pragma once

#include "filasofia/prefab/scope_hands.h"

namespace filasofia::prefab {

/// The pose of the scope's tip, with its roll.
Pose tipOf(const ScopeHandsDef& def, const ScopeHand& hand);

} // namespace filasofia::prefab
