#include "filasofia/runtime/pause_control.h"

#include "filasofia/physics/physics_server.h"

#include <utility>

namespace filasofia::runtime {

bool PauseControl::beginStep(physics::PhysicsServer& physics)
{
    const bool paused = physics.paused() || pauseComes_;
    if (asked_.exchange(false) && paused) {
        physics.pause(false);
        stepping_ = true;
    }
    return !paused || stepping_;
}

void PauseControl::endStep(physics::PhysicsServer& physics)
{
    const bool single = std::exchange(stepping_, false) && !told_.load();
    if (single) physics.pause(true);
    pauseComes_ = single;
    paused_.store(single || physics.paused(), std::memory_order_relaxed);
}

} // namespace filasofia::runtime
