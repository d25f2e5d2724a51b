#pragma once

#include "filasofia/sofa/scene_state.h"

#include "filasofia/physics/motion_watch.h"

/// What a step tells of its elements and of the motion of its bodies, as the native engine does.
namespace filasofia::sofaengine {

/// Elements that are inside out at the start of a step (StepFlag::Inverted). `at`: where bodies are.
void findInverted(const SofaScene& scene, const SceneMotion& at, physics::StepReport& report);

/// Elements that are strained beyond the range of their material (StepFlag::BeyondStrain).
void findStrained(const SofaScene& scene, const SceneMotion& at, physics::StepReport& report);

/// Finds bodies that go on moving though nothing drives them (physics/motion_watch.h).
class SceneWatch {
public:
    /// At the end of a step. `changes`: it began with a command that changes the scene.
    void follow(bool changes, double dt, const SofaScene& scene, physics::StepReport& report);

private:
    std::uint64_t drive_ = 0; ///< hash of what drove the last step
    physics::MotionWatch watch_;
};

} // namespace filasofia::sofaengine
