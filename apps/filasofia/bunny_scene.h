#pragma once

#include "filasofia/filasofia.h"

namespace filasofia::app {

/// The paper's benchmark: the Stanford bunny is pinned at the head and the rest falls under its own weight.
struct BunnyDef {
    int tets = 3004;     ///< one of kBunnySizes
    int subdivision = 1; ///< [-] in [0, 3], subdivision levels of the visual surface
    bool shown = true;   ///< false: not drawn
};

inline constexpr int kBunnySizes[] = {756, 1492, 3004, 10000, 30000};

/// Throws an Error that names the available sizes.
BodyId addBunny(Simulation& sim, const BunnyDef& def);

/// The room in which the bunny swings; the camera looks at it.
Box bunnyRoom();

} // namespace filasofia::app
