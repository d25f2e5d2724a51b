#pragma once

#include "filasofia/engine/scene/scene.h"
#include "filasofia/physics/motion_watch.h"
#include "filasofia/physics/physics_engine.h"

namespace filasofia::engine {

/// Finds bodies that go on moving though nothing drives them (physics/motion_watch.h). What drives a scene are commands
/// that change it, tools and hands that move, forces and pressures that change, and ruptures.
class RestWatch {
public:
    /// Called at the end of a step, with the commands that it began with.
    void follow(const physics::StepInput& in, const Scene& scene, physics::StepReport& report);

private:
    std::uint64_t drive_ = 0; ///< hash of what drove the last step
    physics::MotionWatch watch_;
};

} // namespace filasofia::engine
