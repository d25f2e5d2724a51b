#pragma once

#include "filasofia/core/error.h"
#include "filasofia/scene/scene_def.h"

namespace filasofia::scene {

/// The pose of an element at a time [s], which may be beyond the last key. The keys are not empty and their times
/// ascend.
Pose poseAt(const ElementMotion& motion, double time);

/// A hand that moves along the keys, and its spring.
physics::HapticTarget handAt(const ElementMotion& motion, double time);

/// Throws an Error that begins with `name` unless there is a key and the times ascend from 0.
template <class Key> void checkTimes(const std::vector<Key>& keys, const std::string& name)
{
    if (keys.empty()) fail(name, " must not be empty");
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const double time = keys[i].time, before = i == 0 ? 0.0 : keys[i - 1].time;
        if (!(time >= before) || (i > 0 && time == before))
            fail(name, "[", i, "].time must be later than the key before, at ", before, " s, got ", time);
    }
}

/// The motion with a key at time 0.
ElementMotion withFirstKey(ElementMotion motion, const Pose& start);

/// Throws an Error naming the motion if the body has no such element or joint, or if its keys do not ascend.
void checkMotions(const SceneBody& body);

/// Lets a body begin where the keys at time 0 say, and motions without such a key where the body begins.
void setFirstPoses(const std::vector<ElementMotion>& motions, physics::RigidBodyDef& body);

/// Moves the body before every step of the simulation.
void followMotions(runtime::Simulation& simulation, BodyId id, const SceneBody& body);

} // namespace filasofia::scene
