#pragma once

#include "filasofia/physics/registry.h"

/// Checks of joints, outside the engine.
namespace filasofia::physics {

inline bool isArticulated(const RigidBodyDef& def) { return !def.articulation.joints.empty() || def.articulation.to; }

/// Throws an Error beginning with `object` for errors that a range cannot express: no axis, loops, links that two
/// joints move, limits in the wrong order.
void checkArticulation(const RigidBodyDef& def, const std::string& object);

/// The body that the base follows must exist and be kinematic.
void checkBase(const Registry& registry, const RigidBodyDef& def);
/// For an articulated body, only the base can be set, and only if it does not follow another body.
void checkSettable(const Registry& registry, const RigidBodyDef& def, int element);
void checkCommand(const RigidBodyDef& def, const std::vector<bool>& takesForce, const SetJoint& set);

/// Per joint, whether a force can command it.
std::vector<bool> forceable(const BodyDef& def);

/// Defined in defs.cpp.
void check(const GivenInertia& given, const std::string& object);
RigidInertia inertiaOf(const GivenInertia& given);

} // namespace filasofia::physics
