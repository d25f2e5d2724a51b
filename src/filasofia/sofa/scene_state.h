#pragma once

#include "filasofia/core/hash.h"
#include "filasofia/sofa/sofa_scene.h"

namespace filasofia::sofaengine {

/// What a step changes of the bodies.
struct SceneMotion {
    std::vector<SoftState> soft = {};
    std::vector<RigidState> rigid = {};
};
SceneMotion motionOf(const SofaScene& scene);
/// Whether frames can have every number of it.
bool isUsable(const SofaScene& scene);

/// The whole state of a scene between two steps, without pointers into it.
struct SceneState {
    Vec3 gravity = {}; ///< [m/s^2]
    SceneMotion motion = {};
    std::vector<SoftSettings> soft = {};
    std::vector<RigidSettings> rigid = {};
    std::vector<TieState> ties = {};
    std::vector<physics::Grasp> grasps = {};
    std::vector<FoundContact> contacts = {};
};
SceneState stateOf(const SofaScene& scene);
/// The scene must have the same bodies; ties are made anew. Throws what SOFA throws in making them: nothing has changed
/// then.
void setState(const SceneState& state, SofaScene& scene);
void addTo(Hasher& hash, const SceneState& state);
/// `drive`: only what moves the body from outside.
void addTo(Hasher& hash, const RigidSettings& body, bool drive);

/// Puts every body where its Def says. Attachments, hands and forces stay, and hold from there.
void resetScene(SofaScene& scene);

} // namespace filasofia::sofaengine
