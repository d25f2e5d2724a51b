#pragma once

#include "filasofia/prefab/scope_hands.h"

namespace filasofia::prefab {

/// Where the scope's tip is, with its roll.
Pose tipOf(const ScopeHandsDef& def, const ScopeHand& hand);

} // namespace filasofia::prefab
