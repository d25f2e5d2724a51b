#pragma once

#include "filasofia/runtime/run.h"

/// Physics beside a picture: the bunny of 3004 tetrahedra at steps of 1 ms.
namespace filasofia::app {

/// What the main thread does beside physics.
enum class Beside {
    Nothing, ///< nothing is shown
    Mapping, ///< prepares vertices for a backend that draws nothing
    Picture, ///< 640 x 480 without effects, drawn without a window
};

runtime::RunReport runBeside(Beside what, bool freeRunning, double seconds);

} // namespace filasofia::app
