#pragma once

#include "filasofia/engine/piercing/threading.h"

/// Which lines run through a channel: the needle that pierced it, and the rods that are tied behind it.
namespace filasofia::engine {

/// Adds the rods behind the lines of a channel, as far as they have come to its entry.
void follow(const Scene& scene, const Threading& now, Channel& channel);

} // namespace filasofia::engine
