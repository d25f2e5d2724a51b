#pragma once

#include "filasofia/sofa/collision_plan.h"

namespace filasofia::sofaengine {

/// A rigid body as its node in SOFA is made: checked, plain data of ours, made on any thread.
struct RigidPlan {
    physics::RigidBodyDef def = {};
    /// The same for each element; zero if the body is kinematic. SOFA's points of elements are at this centre of mass;
    /// those of links are at their origins, and it is zero.
    physics::RigidInertia inertia = {};
    std::vector<physics::RigidInertia> links = {}; ///< those of links; empty without joints
    std::vector<CollisionPlan> collision = {};     ///< its collision models
    /// Per collision model: the edges that cut, if it is a blade
    std::vector<std::vector<std::array<int, 2>>> lines = {};
};

/// Throws an Error that names the body and the field if the Def is wrong, or if it asks for what this engine lacks.
RigidPlan planRigid(const physics::RigidBodyDef& def);

/// Whether a body has joints and, as it begins, forces move some of it.
bool isDriven(const physics::RigidBodyDef& def);

} // namespace filasofia::sofaengine
