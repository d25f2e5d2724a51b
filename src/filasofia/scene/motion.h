#pragma once

#include "filasofia/scene/scene_def.h"

namespace filasofia::scene {

/// The pose of an element at a time [s], which may be beyond the last key. The keys are not empty and their times
/// ascend.
Pose poseAt(const ElementMotion& motion, double time);

/// Throws an Error naming the motion if the body has no such element or joint, or if its keys do not ascend.
void checkMotions(const SceneBody& body);

/// Lets a body begin where the keys at time 0 say, and motions without such a key where the body begins.
void setFirstPoses(const std::vector<ElementMotion>& motions, physics::RigidBodyDef& body);

/// Moves the body before every step of the simulation.
void followMotions(runtime::Simulation& simulation, BodyId id, const SceneBody& body);

} // namespace filasofia::scene
