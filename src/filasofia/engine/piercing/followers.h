#pragma once

#include "filasofia/engine/piercing/threading.h"

/// Which lines run through a channel: the needle that pierced it, and the rods that are tied behind it.
namespace filasofia::engine {

/// Adds the rods behind the lines of a channel, also those that have not come to its entry: their contacts at its mouth
/// would drag the tissue along.
void follow(const Scene& scene, Channel& channel);

} // namespace filasofia::engine
