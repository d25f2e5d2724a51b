#pragma once

#include "filasofia/filasofia.h"

namespace filasofia::app {

/// The paper's benchmark: the Stanford bunny pinned at the head, the rest falling under its own weight.
struct BunnyDef {
    int tets = 3004;     ///< one of kBunnySizes
    int subdivision = 1; ///< [-], in [0, 3], of the visual surface
    bool shown = true;   ///< drawn at all
};

inline constexpr int kBunnySizes[] = {756, 1492, 3004, 10000, 30000};

/// Throws an Error naming the sizes that there are.
BodyId addBunny(Simulation& sim, const BunnyDef& def);

/// Where the bunny swings: what the camera looks at.
Box bunnyRoom();

} // namespace filasofia::app
